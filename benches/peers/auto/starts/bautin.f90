! The normal form of a degenerate Hopf point in curved coordinates; PAR(1) = b1, PAR(2) = b2.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: y, rr, fx, fy, om, q, c, a, b
  om = 2d0; q = -0.5d0; c = 0.7d0
  y = u(2) - c*u(1)**2
  rr = u(1)**2 + y**2
  a = par(1) + par(2)*rr - rr**2
  b = om + q*rr
  fx = u(1)*a - y*b
  fy = y*a + u(1)*b
  f(1) = fx
  f(2) = fy + 2d0*c*u(1)*fx
end subroutine func
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 0.1d0
  par(2) = 1d0
  u = 0d0
end subroutine stpnt
subroutine pvls(ndim, u, par)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(in) :: u(ndim)
  double precision, intent(inout) :: par(*)
end subroutine pvls
subroutine bcnd
end subroutine bcnd
subroutine icnd
end subroutine icnd
subroutine fopt
end subroutine fopt
