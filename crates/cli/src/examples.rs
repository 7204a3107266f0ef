//! What the help of each computing command ends with: its examples.

/// Examples by the command's name.
pub const EXAMPLES: [(&str, &str); 9] = [
    ("law", LAW),
    ("integrate", INTEGRATE),
    ("equilibria", EQUILIBRIA),
    ("orbit", ORBIT),
    ("section", SECTION),
    ("branch", BRANCH),
    ("locus", LOCUS),
    ("sweep", SWEEP),
    ("fit", FIT),
];

const LAW: &str = "Example, the paper's law and its extrema:
  twinslip law --format json
  twinslip law --from 1e-3 --to 1e5 --points 400 -o law.csv --plot law.svg";

const INTEGRATE: &str =
    "Example, two interfaces that leave their symmetric steady state for stick-slip:
  twinslip integrate --driving 10 --stiffness 0.14 --until 20 -o run.csv --plot run.svg
Slide-hold-slide, and a ramp of the driving velocity from 1 to 10:
  twinslip integrate --driving 1 --stiffness 0.5 --program 50:0,150:1,200-250:10 --until 300
Another system, from a file with its equations or a built-in one:
  twinslip integrate --system lorenz --until 30 -o lorenz.csv --plot lorenz.svg
Numbers with units, in SI:
  twinslip integrate --driving 10um/s --stiffness 5MPa/mm --until 20s -o run.csv --plot run.svg
A forced system, with t in its formulas:
  twinslip integrate --system duffing --until 200 --points 2001 -o duffing.csv";

const EQUILIBRIA: &str = "Example, the three steady states between the pitchforks of the paper's Fig. 5, with their stability:
  twinslip equilibria --driving 1000 --stiffness 0.45
All equilibria of another system in a box:
  twinslip equilibria --system lorenz --box x=-50:50,y=-50:50,z=-50:100

CSV and JSON have an error bound for each number: stress_uncertainty (in JSON stress.uncertainty), state_uncertainty,
log_state_uncertainty, slip_rate_uncertainty, and eigenvalue_uncertainty, a distance in the complex plane.";

const ORBIT: &str = "Example, the three orbits that coexist at K = 0.05 and V_H = 0.2, the last one unstable:
  twinslip orbit --driving 0.2 --stiffness 0.05
  twinslip orbit --driving 0.2 --stiffness 0.05 --symmetry asymmetric
  twinslip orbit --driving 0.2 --stiffness 0.05 --symmetry asymmetric --start 11.377,1.53e-6,1.83e-4 --period-guess 480
The cycle over one period, as rows and as a picture:
  twinslip orbit --driving 10 --stiffness 0.14 --symmetry asymmetric --points 400 --plot cycle.svg
An orbit of another system:
  twinslip orbit --system van-der-pol --set mu=8";

const SECTION: &str =
    "Example, the torus of the paper's Fig. 13, with its rotation number and exponents:
  twinslip section --driving 0.102 --stiffness 0.2 --lyapunov -o torus.csv --plot torus.svg
The return map of another system:
  twinslip section --system roessler --set c=5.7 --surface x=0 --lyapunov -o roessler.csv --plot roessler.svg";

const BRANCH: &str =
    "Example, all equilibria and their Hopf points at K = 0.14, and the orbits that bifurcate there:
  twinslip branch equilibria --stiffness 0.14 -o equilibria.csv --plot equilibria.svg
  twinslip branch orbits --stiffness 0.14 --from 0.05 --to 300 -o orbits.csv --plot orbits.svg";

const LOCUS: &str =
    "Example, the torus bifurcations of the paper's Figs 12 and 14, with their resonances:
  twinslip locus torus --stiffness-range 0.05,0.3 -o torus.csv --plot torus.svg";

const SWEEP: &str = "Example, the regimes on 40 x 40 points and their map; then the same resumed after an interruption:
  twinslip sweep --driving 0.04:0.2:40 --stiffness 0.02:0.25:40 -o map.csv --plot map.svg
  twinslip sweep --driving 0.04:0.2:40 --stiffness 0.02:0.25:40 --resume map.csv --plot map.svg
Over other parameters, of interfaces and of another system:
  twinslip sweep --driving 0.1 --stiffness 0.1:0.25:30 --grid residual_strength_2=1e-4:1e-2:40log -o map.csv --plot map.svg
  twinslip sweep --system roessler --grid c=2:6:60 --grid a=0.1:0.3:40 -o roessler.csv --plot roessler.svg
Basins of attraction, where a symmetric and an asymmetric orbit coexist:
  twinslip sweep --basin --driving 0.08 --stiffness 0.1 --state-1 1e-6:1:40log --state-2 1e-6:1:40log -o basin.csv";

const FIT: &str =
    "Example, a velocity step on basalt powder, by the slip law and by the ageing law:
  twinslip fit basalt.txt --law slip,dieterich-ruina --plot fit.svg --report fit.html
The uncertainty of the fit propagated to the law and the critical stiffness:
  twinslip fit basalt.txt --law slip -o fit.json
  twinslip law --ensemble fit.json --plot law.svg";
