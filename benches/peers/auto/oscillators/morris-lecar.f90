! Morris and Lecar (1981) with the parameters of Rinzel and Ermentrout (1998), Hopf regime: the state (V, w), PAR(1) = I.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: m, m_v, winf, winf_v, rate, rate_v
  m = 0.5d0*(1d0 + tanh((u(1) + 1.2d0)/18d0))
  winf = 0.5d0*(1d0 + tanh((u(1) - 2d0)/30d0))
  rate = 0.04d0*cosh((u(1) - 2d0)/60d0)
  f(1) = (par(1) - 2d0*(u(1) + 60d0) - 4.4d0*m*(u(1) - 120d0) - 8d0*u(2)*(u(1) + 84d0))/20d0
  f(2) = rate*(winf - u(2))
  if (ijac == 0) return
  m_v = 0.5d0/(18d0*cosh((u(1) + 1.2d0)/18d0)**2)
  winf_v = 0.5d0/(30d0*cosh((u(1) - 2d0)/30d0)**2)
  rate_v = 0.04d0*sinh((u(1) - 2d0)/60d0)/60d0
  dfdu(1, 1) = (-2d0 - 4.4d0*(m_v*(u(1) - 120d0) + m) - 8d0*u(2))/20d0
  dfdu(1, 2) = -8d0*(u(1) + 84d0)/20d0
  dfdu(2, 1) = rate_v*(winf - u(2)) + rate*winf_v
  dfdu(2, 2) = -rate
  if (ijac == 1) return
  dfdp(1, 1) = 1d0/20d0
  dfdp(2, 1) = 0d0
end subroutine func

! near the steady state at I = 80; AUTO's first step corrects it
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 80d0
  u(1) = -29.966d0
  u(2) = 0.1061d0
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
