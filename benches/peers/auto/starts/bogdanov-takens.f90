! The normal form of a double zero; PAR(1) = b1, PAR(2) = b2.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  f(1) = u(2)
  f(2) = par(1) + par(2)*u(1) + u(1)**2 - u(1)*u(2)
end subroutine func
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 0.1d0
  par(2) = -1d0
  u(1) = 0.5d0 - sqrt(0.25d0 - 0.1d0)
  u(2) = 0d0
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
