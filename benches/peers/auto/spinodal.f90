! Two interfaces under one stress with the spinodal law: equations (19) and (35) of Putelat, Willis & Dawes (2008), for AUTO-07p.
!
!   dtau/dt = K (V_H - v_1 - v_2),   dpsi_i/dt = (1 - psi_i)/R - v_i psi_i,   v_i = gamma0 sinh(tau) [c + (1+R) psi_i]^(-beta)
!
! State (tau, ln psi_1, ln psi_2); time in units of 1/V_H, so that the period stays near one size while V_H runs over six decades.
! PAR(1) = ln V_H, PAR(2) = ln K, PAR(11) = V_H T. All first derivatives are given (JAC = 1).

module spinodal
  implicit none
  double precision, parameter :: beta = 489d0/349d0, r = 100d0, c = 1d-3
  double precision :: gamma0 = 0d0
contains
  ! v and its derivatives with respect to tau and w = ln psi, and psi
  subroutine slip(tau, w, psi, v, v_tau, v_w)
    double precision, intent(in) :: tau, w
    double precision, intent(out) :: psi, v, v_tau, v_w
    double precision :: strength, grown, weakening
    if (gamma0 == 0d0) gamma0 = 2d0*exp(-3690d0/349d0)
    psi = exp(w)
    strength = c + (1d0 + r)*psi
    weakening = gamma0*strength**(-beta)
    grown = exp(tau)
    v = weakening*0.5d0*(grown - 1d0/grown)
    v_tau = weakening*0.5d0*(grown + 1d0/grown)
    v_w = -beta*v*(1d0 + r)*psi/strength
  end subroutine slip
end module spinodal

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use spinodal
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: driving, k, psi(2), v(2), v_tau(2), v_w(2), sum_v
  integer :: i
  driving = exp(par(1))
  k = exp(par(2))
  do i = 1, 2
    call slip(u(1), u(1 + i), psi(i), v(i), v_tau(i), v_w(i))
    f(1 + i) = ((1d0/psi(i) - 1d0)/r - v(i))/driving
  end do
  sum_v = (v(1) + v(2))/driving
  f(1) = k*(1d0 - sum_v)
  if (ijac == 0) return
  dfdu(1, 1) = -k*(v_tau(1) + v_tau(2))/driving
  do i = 1, 2
    dfdu(1, 1 + i) = -k*v_w(i)/driving
    dfdu(1 + i, 1) = -v_tau(i)/driving
    dfdu(1 + i, 1 + i) = -(1d0/(r*psi(i)) + v_w(i))/driving
    dfdu(1 + i, 4 - i) = 0d0
  end do
  if (ijac == 1) return
  dfdp(1, 1) = k*sum_v
  dfdp(2, 1) = -f(2)
  dfdp(3, 1) = -f(3)
  dfdp(1, 2) = f(1)
  dfdp(2, 2) = 0d0
  dfdp(3, 2) = 0d0
end subroutine func

! the symmetric steady state at V_H = 0.03
subroutine stpnt(ndim, u, par, t)
  use spinodal
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  double precision :: v, psi, scale
  par(1) = log(0.03d0)
  par(2) = log(0.14d0)
  v = 0.5d0*exp(par(1))
  psi = 1d0/(1d0 + r*v)
  scale = v*(c + (1d0 + r)*psi)**beta/(2d0*exp(-3690d0/349d0))
  u(1) = asinh(scale)
  u(2) = log(psi)
  u(3) = u(2)
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
