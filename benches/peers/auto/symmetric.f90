! The symmetric orbits of two interfaces as a boundary-value problem in the plane, for AUTO-07p: equations (19) and (35) with
! psi_1 = psi_2, and the pitchfork of orbits as one integral condition.
!
!   dtau/dt = K (V_H - 2 v),   dpsi/dt = (1 - psi)/R - v psi,   time in units of 1/V_H
!   d ln D/dt = lambda, the growth of the difference D of the two interfaces,
!   lambda = -1/(R psi) + beta v (1+R) psi / [c + (1+R) psi]
!
! State (tau, ln psi, ln D). lambda is the antisymmetric entry of the Jacobian matrix of (19), its integral over one period is
! ln mu_anti, and the pitchfork is ln mu_anti = 0. As a third component that integral is as accurate as the orbit; as an
! integral condition (ICND) it was two to three digits worse, since AUTO integrates over all its nodes and not the Gauss points.
! PAR(1) = ln V_H, PAR(2) = ln K, PAR(3) = ln mu_anti, PAR(11) = V_H T. PAR(9) = 0 in the run that leaves the Hopf point
! (IPS = 2, where AUTO scales time by the period itself) and 1 in boundary-value problems (IPS = 4).

module symmetric
  implicit none
  double precision, parameter :: beta = 489d0/349d0, r = 100d0, c = 1d-3
contains
  ! psi, v with its derivatives with respect to tau and w = ln psi, and lambda with its own
  subroutine slip(tau, w, psi, v, v_tau, v_w, lambda, lambda_tau, lambda_w)
    double precision, intent(in) :: tau, w
    double precision, intent(out) :: psi, v, v_tau, v_w, lambda, lambda_tau, lambda_w
    double precision :: strength, share, weakening, grown, v_ww
    psi = exp(w)
    strength = c + (1d0 + r)*psi
    share = (1d0 + r)*psi/strength
    weakening = 2d0*exp(-3690d0/349d0)*strength**(-beta)
    grown = exp(tau)
    v = weakening*0.5d0*(grown - 1d0/grown)
    v_tau = weakening*0.5d0*(grown + 1d0/grown)
    v_w = -beta*v*share
    v_ww = v_w*(1d0 - share - beta*share)
    lambda = -1d0/(r*psi) - v_w
    lambda_tau = beta*v_tau*share
    lambda_w = 1d0/(r*psi) - v_ww
  end subroutine slip
end module symmetric

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use symmetric
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: driving, k, psi, v, v_tau, v_w, lambda, lambda_tau, lambda_w, scale, rate(2)
  driving = exp(par(1))
  k = exp(par(2))
  scale = 1d0/driving
  if (par(9) > 0.5d0) scale = scale*par(11)
  call slip(u(1), u(2), psi, v, v_tau, v_w, lambda, lambda_tau, lambda_w)
  rate(1) = k*(driving - 2d0*v)
  rate(2) = (1d0/psi - 1d0)/r - v
  f(1:2) = scale*rate
  if (ndim == 3) f(3) = scale*lambda
  if (ijac == 0) return
  dfdu(1, 1) = -2d0*scale*k*v_tau
  dfdu(1, 2) = -2d0*scale*k*v_w
  dfdu(2, 1) = -scale*v_tau
  dfdu(2, 2) = scale*lambda
  if (ndim == 3) then
    dfdu(3, 1) = scale*lambda_tau
    dfdu(3, 2) = scale*lambda_w
    dfdu(:, 3) = 0d0
  end if
  if (ijac == 1) return
  dfdp(1, 1) = 2d0*scale*k*v
  dfdp(2, 1) = -f(2)
  dfdp(1, 2) = f(1)
  dfdp(2, 2) = 0d0
  dfdp(1:2, 3) = 0d0
  dfdp(1:2, 11) = rate/driving
  if (ndim == 3) then
    dfdp(3, 1) = -f(3)
    dfdp(3, 2:3) = 0d0
    dfdp(3, 11) = lambda/driving
  end if
end subroutine func

! the steady state at V_H = 0.03
subroutine stpnt(ndim, u, par, t)
  use symmetric
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  double precision :: v, psi
  par(1) = log(0.03d0)
  par(2) = log(0.13d0)
  par(3) = 0d0
  par(9) = 0d0
  v = 0.5d0*exp(par(1))
  psi = 1d0/(1d0 + r*v)
  u(1) = asinh(v*(c + (1d0 + r)*psi)**beta/(2d0*exp(-3690d0/349d0)))
  u(2) = log(psi)
end subroutine stpnt

! the orbit closes; D grows from 1 to mu_anti
subroutine bcnd(ndim, par, icp, nbc, u0, u1, fb, ijac, dbc)
  implicit none
  integer, intent(in) :: ndim, icp(*), nbc, ijac
  double precision, intent(in) :: par(*), u0(ndim), u1(ndim)
  double precision, intent(out) :: fb(nbc)
  double precision, intent(inout) :: dbc(nbc, *)
  integer :: i
  fb(1:2) = u1(1:2) - u0(1:2)
  fb(3) = u0(3)
  fb(4) = u1(3) - par(3)
  if (ijac == 0) return
  dbc(1:4, 1:6) = 0d0
  do i = 1, 2
    dbc(i, i) = -1d0
    dbc(i, 3 + i) = 1d0
  end do
  dbc(3, 3) = 1d0
  dbc(4, 6) = 1d0
  if (ijac == 1) return
  dbc(1:4, 7:17) = 0d0
  dbc(4, 9) = -1d0
end subroutine bcnd

! the phase along the last orbit found
subroutine icnd(ndim, par, icp, nint, u, uold, udot, upold, fi, ijac, dint)
  implicit none
  integer, intent(in) :: ndim, icp(*), nint, ijac
  double precision, intent(in) :: par(*), u(ndim), uold(ndim), udot(ndim), upold(ndim)
  double precision, intent(out) :: fi(nint)
  double precision, intent(inout) :: dint(nint, *)
  fi(1) = (u(1) - uold(1))*upold(1) + (u(2) - uold(2))*upold(2)
  if (ijac == 0) return
  dint(1, 1:2) = upold(1:2)
  dint(1, 3) = 0d0
  if (ijac == 1) return
  dint(1, 4:14) = 0d0
end subroutine icnd

subroutine fopt
end subroutine fopt
subroutine pvls
end subroutine pvls
