! The Brusselator with A = 1 up to B = 26.5, where its orbits are of relaxation: the state (x, y), PAR(1) = B.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  f(1) = 1d0 + u(1)**2*u(2) - (par(1) + 1d0)*u(1)
  f(2) = par(1)*u(1) - u(1)**2*u(2)
  if (ijac == 0) return
  dfdu(1, 1) = 2d0*u(1)*u(2) - par(1) - 1d0
  dfdu(1, 2) = u(1)**2
  dfdu(2, 1) = par(1) - 2d0*u(1)*u(2)
  dfdu(2, 2) = -u(1)**2
  if (ijac == 1) return
  dfdp(1, 1) = -u(1)
  dfdp(2, 1) = u(1)
end subroutine func

! the steady state at B = 1.5
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 1.5d0
  u(1) = 1d0
  u(2) = 1.5d0
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
