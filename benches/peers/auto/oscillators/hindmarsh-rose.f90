! Hindmarsh and Rose (1984), bursts of spikes: the state (x, y, z), PAR(1) = I, r = 0.005.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision, parameter :: r = 0.005d0
  f(1) = u(2) - u(1)**3 + 3d0*u(1)**2 - u(3) + par(1)
  f(2) = 1d0 - 5d0*u(1)**2 - u(2)
  f(3) = r*(4d0*(u(1) + 1.6d0) - u(3))
  if (ijac == 0) return
  dfdu(1, 1) = -3d0*u(1)**2 + 6d0*u(1)
  dfdu(1, 2) = 1d0
  dfdu(1, 3) = -1d0
  dfdu(2, 1) = -10d0*u(1)
  dfdu(2, 2) = -1d0
  dfdu(2, 3) = 0d0
  dfdu(3, 1) = 4d0*r
  dfdu(3, 2) = 0d0
  dfdu(3, 3) = -r
  if (ijac == 1) return
  dfdp(1, 1) = 1d0
  dfdp(2, 1) = 0d0
  dfdp(3, 1) = 0d0
end subroutine func

! near the steady state at I = 1; AUTO's first step corrects it
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 1d0
  u = (/ -1.3944d0, -8.7214d0, 0.8225d0 /)
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
