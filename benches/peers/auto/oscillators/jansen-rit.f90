! Jansen and Rit (1995), a column of the cortex: the state (y_0, ..., y_5), PAR(1) = p.

module sigmoid
  implicit none
contains
  ! the firing rate and its derivative
  subroutine fires(v, s, s_v)
    double precision, intent(in) :: v
    double precision, intent(out) :: s, s_v
    double precision :: grown
    grown = exp(0.56d0*(6d0 - v))
    s = 5d0/(1d0 + grown)
    s_v = 0.56d0*s*grown/(1d0 + grown)
  end subroutine fires
end module sigmoid

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use sigmoid
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: sa, sa_v, sb, sb_v, sc, sc_v
  call fires(u(2) - u(3), sa, sa_v)
  call fires(135d0*u(1), sb, sb_v)
  call fires(33.75d0*u(1), sc, sc_v)
  f(1:3) = u(4:6)
  f(4) = 325d0*sa - 200d0*u(4) - 1d4*u(1)
  f(5) = 325d0*(par(1) + 108d0*sb) - 200d0*u(5) - 1d4*u(2)
  f(6) = 1100d0*33.75d0*sc - 100d0*u(6) - 2500d0*u(3)
  if (ijac == 0) return
  dfdu = 0d0
  dfdu(1, 4) = 1d0
  dfdu(2, 5) = 1d0
  dfdu(3, 6) = 1d0
  dfdu(4, 1) = -1d4
  dfdu(4, 2) = 325d0*sa_v
  dfdu(4, 3) = -325d0*sa_v
  dfdu(4, 4) = -200d0
  dfdu(5, 1) = 325d0*108d0*135d0*sb_v
  dfdu(5, 2) = -1d4
  dfdu(5, 5) = -200d0
  dfdu(6, 1) = 1100d0*33.75d0**2*sc_v
  dfdu(6, 3) = -2500d0
  dfdu(6, 6) = -100d0
  if (ijac == 1) return
  dfdp(:, 1) = 0d0
  dfdp(5, 1) = 325d0
end subroutine func

! near the steady state at p = 50; AUTO's first step corrects it
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 50d0
  u = (/ 0.09188d0, 18.702d0, 12.232d0, 0d0, 0d0, 0d0 /)
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
