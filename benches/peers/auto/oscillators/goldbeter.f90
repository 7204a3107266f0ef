! Goldbeter (1991), the mitotic oscillator: cyclin C, active kinase M and protease X; PAR(1) = v_i.

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision, parameter :: vd = 0.25d0, kdd = 0.02d0, kd = 0.01d0, vm1 = 3d0, kc = 0.5d0, v2 = 1.5d0, vm3 = 1d0, v4 = 0.5d0, &
    k = 0.005d0
  double precision :: c, m, x, eaten, on
  c = u(1)
  m = u(2)
  x = u(3)
  eaten = c/(kdd + c)
  on = c/(kc + c)
  f(1) = par(1) - vd*x*eaten - kd*c
  f(2) = vm1*on*(1d0 - m)/(k + 1d0 - m) - v2*m/(k + m)
  f(3) = vm3*m*(1d0 - x)/(k + 1d0 - x) - v4*x/(k + x)
  if (ijac == 0) return
  dfdu(1, 1) = -vd*x*kdd/(kdd + c)**2 - kd
  dfdu(1, 2) = 0d0
  dfdu(1, 3) = -vd*eaten
  dfdu(2, 1) = vm1*kc/(kc + c)**2*(1d0 - m)/(k + 1d0 - m)
  dfdu(2, 2) = -vm1*on*k/(k + 1d0 - m)**2 - v2*k/(k + m)**2
  dfdu(2, 3) = 0d0
  dfdu(3, 1) = 0d0
  dfdu(3, 2) = vm3*(1d0 - x)/(k + 1d0 - x)
  dfdu(3, 3) = -vm3*m*k/(k + 1d0 - x)**2 - v4*k/(k + x)**2
  if (ijac == 1) return
  dfdp(1, 1) = 1d0
  dfdp(2, 1) = 0d0
  dfdp(3, 1) = 0d0
end subroutine func

! near the steady state at v_i = 0.005; AUTO's first step corrects it
subroutine stpnt(ndim, u, par, t)
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  par(1) = 0.005d0
  u = (/ 0.46475d0, 0.1142d0, 0.00147d0 /)
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
