! FitzHugh and Nagumo with epsilon = 0.01, so that orbits next to both Hopf points are canards: the state (v, w), PAR(1) = I.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision, parameter :: e = 0.01d0
  f(1) = u(1) - u(1)**3/3d0 - u(2) + par(1)
  f(2) = e*(u(1) + 0.7d0 - 0.8d0*u(2))
  if (ijac == 0) return
  dfdu(1, 1) = 1d0 - u(1)**2
  dfdu(1, 2) = -1d0
  dfdu(2, 1) = e
  dfdu(2, 2) = -0.8d0*e
  if (ijac == 1) return
  dfdp(1, 1) = 1d0
  dfdp(2, 1) = 0d0
end subroutine func

! near the steady state at I = 0.1; AUTO's first step corrects it
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 0.1d0
  u(1) = -1.1375d0
  u(2) = -0.5469d0
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
