// Formulas of the pages that move, by derivation file.
// Generated from derivations/ by `meso-robust derive`; do not edit.
// Angles are in rad, all lengths in one unit; every function returns an array.
const formulas = {
  one_point_sticking: {
    // lambda_n F / (e_x |v_p|), m^2: the tip pushes where it is positive
    normal_force(theta, d1, d2, rho) {
      return [d1*d2*Math.cos(theta) + (Math.pow(d1, 2) + rho)*Math.sin(theta)];
    },
    // mu lambda_n -+ lambda_t, same scale, m^2: both positive where the contact sticks
    friction_margin(theta, d1, d2, rho, mu) {
      const x0 = Math.cos(theta);
      const x1 = d1*d2;
      const x2 = Math.pow(d2, 2) + rho;
      const x3 = Math.sin(theta);
      const x4 = Math.pow(d1, 2)*mu + mu*rho;
      return [x0*(mu*x1 + x2) + x3*(x1 + x4), x0*(d1*d2*mu - x2) + x3*(-x1 + x4)];
    },
    // lambda_t/lambda_n of the sticking solution; the contact's own ratio is this one, clipped to [-mu, mu], wherever `only_solution` and `normal_force` are positive
    stick_ratio(theta, d1, d2, rho) {
      const x0 = Math.cos(theta);
      const x1 = d1*d2;
      const x2 = Math.sin(theta);
      return [(x0*(-Math.pow(d2, 2) - rho) - x1*x2)/(x0*x1 + x2*(Math.pow(d1, 2) + rho))];
    },
    // side F d(theta)/d(travel), m: positive where the part turns counter-clockwise (side = 1) or clockwise (side = -1)
    turning(theta, d1, d2, side) {
      return [side*(-d1*Math.cos(theta) + d2*Math.sin(theta))];
    },
    // m^2: both positive where a sticking solution excludes every slipping one
    only_solution(d1, d2, rho, mu) {
      const x0 = d1*d2*mu;
      const x1 = Math.pow(d2, 2) + rho;
      return [-x0 + x1, x0 + x1];
    },
  },
  sticking_motion: {
    // m: travel of the tip in sticking contact that turns the part from start to end
    travel(theta_start, theta_end, d1, d2, rho) {
      const x0 = Math.pow(d1, 2) + Math.pow(d2, 2);
      const x1 = Math.sqrt(x0);
      const x2 = Math.cos(theta_start);
      const x3 = Math.sin(theta_start);
      const x4 = Math.cos(theta_end);
      const x5 = Math.sin(theta_end);
      const x6 = -x1;
      return [(rho + x0)*Math.log((-d1*x2 + d2*x3)*(-d1*x5 - d2*x4 - x6)/((-d1*x4 + d2*x5)*(-d1*x3 - d2*x2 - x6)))/x1];
    },
    // m: contact point minus centre, world axes
    arm(theta, d1, d2) {
      const x0 = Math.sin(theta);
      const x1 = Math.cos(theta);
      return [d1*x0 + d2*x1, -d1*x1 + d2*x0];
    },
    // m: offset d2 along the edge of a tip that is `rise` above the centre
    contact_offset(theta, d1, rise) {
      return [(d1*Math.cos(theta) + rise)/Math.sin(theta)];
    },
    // m: how far right of the centre a tip that is `rise` above it meets the edge
    contact_reach(theta, d1, rise) {
      return [(d1 + rise*Math.cos(theta))/Math.sin(theta)];
    },
    // m^2: where positive, a contact further up the edge (d2) needs less travel to turn the part counter-clockwise, more to turn it clockwise
    shortening(theta, d1, d2, rho) {
      return [2*d1*d2*Math.cos(theta) + (Math.pow(d1, 2) - Math.pow(d2, 2) + rho)*Math.sin(theta)];
    },
    // m: rise of the centre while the part turns from start to end about the contact
    lift(theta_start, theta_end, d1, d2) {
      return [d1*(Math.cos(theta_end) - Math.cos(theta_start)) + d2*(-Math.sin(theta_end) + Math.sin(theta_start))];
    },
    // m: distance from the edge's line of a point (dx, dy) from the centre
    clearance(theta, d1, dx, dy) {
      return [-d1 + dx*Math.sin(theta) - dy*Math.cos(theta)];
    },
    // m: how far the second tip, (dx, dy) from the touching one, is off the edge's line and beyond its end; it is clear of the part where either is positive
    beside(theta, d2, half, dx, dy, side) {
      const x0 = Math.sin(theta);
      const x1 = Math.cos(theta);
      return [dx*x0 - dy*x1, d2*side + dx*side*x1 + dy*side*x0 - half];
    },
  },
  two_point_sticking: {
    // lambda_n of tips 1 and 2, times d4/(e_x |v_p| cos(beta)), m: both must be positive
    normal_forces(beta, d1, d2, d4) {
      const x0 = d1*Math.sin(beta) + d2*Math.cos(beta);
      return [d4 - x0, x0];
    },
    // mu lambda_n -+ lambda_t over e_x |v_p|: both positive where the pair sticks
    friction_margin(beta, mu) {
      const x0 = mu*Math.cos(beta);
      const x1 = Math.sin(beta);
      return [x0 - x1, x0 + x1];
    },
  },
  two_sided_rotation: {
    // cos and sin of theta while both tips touch; (h, V): from S to D, m
    orientation(h, V, d1) {
      const x0 = Math.pow(V, 2) + Math.pow(h, 2);
      const x1 = 1/x0;
      const x2 = 2*d1;
      const x3 = Math.sqrt(-4*Math.pow(d1, 2) + x0);
      return [x1*(-V*x2 + h*x3), x1*(V*x3 + h*x2)];
    },
    // h, m, at which both tips touch a part of orientation theta
    pair_position(theta, V, d1) {
      const x0 = Math.sin(theta);
      const x1 = 2*d1;
      const x2 = Math.cos(theta);
      return [x0*x1 + x2*(V + x1*x2)/x0];
    },
    // d(sigma)/d(travel) at friction ratios (tau_D, tau_S) = mu (-1, -1), mu (-1, 1), mu (1, -1), mu (1, 1), and half of dT/d(travel)
    slide_rates(h, V, d1, sigma, rho, mu) {
      const x0 = Math.pow(V, 2) + Math.pow(h, 2);
      const x1 = 1/x0;
      const x2 = 2*d1;
      const x3 = -4*Math.pow(d1, 2) + x0;
      const x4 = Math.sqrt(x3);
      const x5 = -V*x2 + h*x4;
      const x6 = -1/2*x1*x5;
      const x7 = 2*rho;
      const x8 = 2*sigma;
      const x9 = mu*x2;
      const x10 = -sigma - 1/2*x4;
      const x11 = mu*x1*(V*x4 + h*x2);
      const x12 = x11/x3;
      const x13 = (1/2)*x1*x5;
      const x14 = 1/x4;
      const x15 = x10*x11*x14;
      return [-x12*(x10*(-x8 - x9) + x7) - x6, x13 + x15, -x15 - x6, x12*(x10*(-x8 + x9) + x7) + x13, -1/2*h*x14];
    },
    // T, m: distance of the contacts along a
    pair(h, V, d1) {
      return [Math.sqrt(Math.pow(V, 2) - 4*Math.pow(d1, 2) + Math.pow(h, 2))];
    },
    // normal force at S over e_x and travel rate; where positive for all ratios, D alone would press the part on S
    passive_force(h, V, d1, sigma, rho, tau_D, tau_S) {
      const x0 = Math.pow(V, 2) + Math.pow(h, 2);
      const x1 = Math.sqrt(-4*Math.pow(d1, 2) + x0);
      const x2 = (1/2)*x1;
      return [(rho + (-sigma - x2)*(d1*tau_D - sigma + x2))*(V*x1 + 2*d1*h)/(x0*x1*(d1*(tau_D - tau_S) + x1))];
    },
    // m^2: positive where the grasp cannot close
    no_jam(V, d1, mu) {
      return [Math.pow(V, 2) - 4*Math.pow(d1, 2)*(Math.pow(mu, 2) + 1)];
    },
    // velocity of the centre per travel while D alone pushes with friction ratio tau
    one_contact_motion(theta, d1, d2, rho, tau) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = rho*x1/(d1*d2*tau + Math.pow(d2, 2) + rho);
      return [-x2*(-tau*x0 + x1), x2*(tau*x1 + x0)];
    },
    // turn per travel while D alone pushes with friction ratio tau
    one_contact_turning(theta, d1, d2, rho, tau) {
      const x0 = d1*tau;
      return [(d2 + x0)*Math.sin(theta)/(Math.pow(d2, 2) + d2*x0 + rho)];
    },
    // speed per travel at which the far edge closes on S at offset p_S, D alone pushing
    closing(theta, d1, d2, p_S, rho, tau) {
      const x0 = d1*tau;
      return [(p_S*(d2 + x0) + rho)*Math.sin(theta)/(Math.pow(d2, 2) + d2*x0 + rho)];
    },
  },
  round_tips: {
    // m: travel along `direction` until a tip of radius r touches whose centre is at (dx, dy) from the reference point, and d2 of its contact
    touch(theta, direction, d1, r, dx, dy) {
      const x0 = direction - theta;
      const x1 = 1/Math.sin(x0);
      const x2 = d1 + r;
      return [-x1*(dx*Math.sin(theta) - dy*Math.cos(theta) - x2), -x1*(-dx*Math.sin(direction) + dy*Math.cos(direction) + x2*Math.cos(x0))];
    },
    // m: d2 of the contact that was at d2 when the edge was at theta_start
    rolled(theta, theta_start, d2, r) {
      return [d2 - r*(theta - theta_start)];
    },
    // m: how much closer the upper of two tips is to the edge: zero where both touch
    upper_first(theta, beta, spacing, r_upper, r_lower) {
      return [-r_lower + r_upper + spacing*Math.cos(beta - theta)/Math.cos(beta)];
    },
    // m: distance of the two tips along the edge
    contact_gap(theta, beta, spacing) {
      return [-spacing*Math.sin(beta - theta)/Math.cos(beta)];
    },
  },
  opposite_edges: {
    // W, m: distance of the centres of both tips across D's edge
    width(q, d_D, d_S, r_D, r_S, kappa) {
      return [d_D - q*Math.sin(kappa) + r_D + (d_S + r_S)*Math.cos(kappa)];
    },
    // T, m: distance of the centres of both tips along D's edge
    apart(h, clear, W) {
      return [Math.sqrt(clear*(2*W + clear) + Math.pow(h, 2))];
    },
    // V - W, m, of the distance of the tips across the travel less both radii and depths
    clear(q, d_S, r_S, kappa, room) {
      return [q*Math.sin(kappa) + room + (2*d_S + 2*r_S)*Math.pow(Math.sin((1/2)*kappa), 2)];
    },
    // cos and sin of the direction of D's edge while both tips touch
    direction(h, V, W, T) {
      const x0 = 1/(Math.pow(V, 2) + Math.pow(h, 2));
      return [x0*(T*h - V*W), x0*(T*V + W*h)];
    },
    // p_D, m: contact of D along its edge from the foot of the reference point
    active_offset(T, q, d_S, r_S, kappa) {
      return [T - q*Math.cos(kappa) - (d_S + r_S)*Math.sin(kappa)];
    },
    // x and y of the reference point minus those of the centre of S, m
    place(c, s, q, d_S, r_S, kappa) {
      const x0 = Math.cos(kappa);
      const x1 = Math.sin(kappa);
      const x2 = d_S + r_S;
      const x3 = q*x0 + x1*x2;
      const x4 = q*x1 - x0*x2;
      return [c*x3 - s*x4, c*x4 + s*x3];
    },
    // dq/d(travel) at which D, S stick; above it the part slips towards +a over the tip
    stick_rates(c, s, T, q, d_D, d_S, r_D, r_S, kappa, bend) {
      const x0 = Math.cos(kappa);
      const x1 = Math.sin(kappa);
      const x2 = d_D - q*x1 + x0*(d_S + r_S);
      const x3 = bend*c + s;
      return [(-T*(-bend*s + c) - x2*x3)/(T*x0 - x1*x2), -r_S*x3/(T - r_S*x1)];
    },
    // dq/d(travel) at friction ratios tau_D, tau_S, of the sum total; the same less that at which D, S stick
    corner(c, s, T, q, d_D, d_S, r_D, r_S, kappa, drag_a, drag_n, rho, stretch, shear, bend, tau_D, tau_S, total) {
      const x0 = Math.sin(kappa);
      const x1 = shear*x0;
      const x2 = Math.cos(kappa);
      const x3 = stretch + 1;
      const x4 = shear*x2;
      const x5 = 1 - stretch;
      const x6 = tau_S*x2 + x0;
      const x7 = -tau_S*x0 + x2;
      const x8 = 1/x7;
      const x9 = drag_a*x0 + drag_n*x2;
      const x10 = d_S + x9;
      const x11 = -tau_S*x10;
      const x12 = drag_a*x2 - drag_n*x0 + q;
      const x13 = d_S + r_S;
      const x14 = x13 + x9;
      const x15 = (total*x2 + x0*(-tau_D*tau_S + 1))/(x0*(x12*x6 - x14*x7) + x11 + x7*(T + tau_D*(d_D - drag_n)));
      const x16 = -x15*x8*(x11 + x12) + x6*x8;
      const x17 = -(rho*x15 + x12*(x0*x3 - x16*(x1 + x2*x5) + x4))/(-x1 - x16*(-x0*x5 + x4) + x2*x3);
      const x18 = x14 + x17;
      const x19 = -x18;
      const x20 = bend*c + s;
      const x21 = x20/(T + x0*x19);
      const x22 = -bend*s + c;
      const x23 = (-T*x22 - x20*(d_D - q*x0 + x13*x2))/(x0*x22 + x2*x20);
      const x24 = T*x21;
      return [x19*x21, x24*(-x18 - x23)/(T + x0*x23), x24*(-x10 - x17)/(T - r_S*x0)];
    },
    // normal force at S, at friction ratios -mu_D and mu_D, then at D, at -mu_S and mu_S, then at S if D has no friction, over e_x and travel rate, times the grip
    corner_forces(c, s, T, q, d_D, d_S, r_S, kappa, drag_a, drag_n, rho, stretch, shear, bend, mu_D, mu_S) {
      const x0 = Math.cos(kappa);
      const x1 = Math.sin(kappa);
      const x2 = shear*x0 - x1*(1 - stretch);
      const x3 = mu_D*x2;
      const x4 = shear*x1;
      const x5 = stretch + 1;
      const x6 = -x0*x5 + x4;
      const x7 = mu_D*(d_D - drag_n);
      const x8 = drag_a*x0 - drag_n*x1 + q;
      const x9 = x0*x8;
      const x10 = d_S + drag_a*x1 + drag_n*x0;
      const x11 = x1*(r_S + x10);
      const x12 = -T + x11 + x9;
      const x13 = x8*(-Math.pow(shear, 2) - Math.pow(stretch, 2) + 1);
      const x14 = (bend*c + s)/T;
      const x15 = mu_S*x1;
      const x16 = -x6;
      const x17 = mu_S*x0;
      const x18 = mu_S*x10;
      return [x14*(rho*(-x3 - x6) - x13*(-x12 - x7)), x14*(rho*(x0*x5 + x3 - x4) - x13*(T - x11 + x7 - x9)), x14*(rho*(x16*(x0 + x15) - x2*(x1 - x17)) + x13*(x18 + x8)), x14*(rho*(x16*(x0 - x15) - x2*(x1 + x17)) + x13*(-x18 + x8)), x14*(rho*x16 + x12*x13)];
    },
    // grip, m, at the same ratios: where positive the tips cannot close on the part
    corner_grips(c, s, T, q, d_D, d_S, r_S, kappa, drag_a, drag_n, rho, stretch, shear, bend, mu_D, mu_S) {
      const x0 = Math.sin(kappa);
      const x1 = mu_D*mu_S;
      const x2 = x0*(1 - x1);
      const x3 = Math.cos(kappa);
      const x4 = mu_D + mu_S;
      const x5 = x2 - x3*x4;
      const x6 = drag_a*x3 - drag_n*x0 + q;
      const x7 = shear*x0;
      const x8 = 1 - stretch;
      const x9 = x3*x8 + x7;
      const x10 = mu_S*x0;
      const x11 = x10 + x3;
      const x12 = 1/x11;
      const x13 = d_S + drag_a*x0 + drag_n*x3;
      const x14 = mu_S*x13;
      const x15 = x12*(x14 + x6);
      const x16 = x15*x5;
      const x17 = mu_S*x3;
      const x18 = x0 - x17;
      const x19 = x12*x18;
      const x20 = shear*x3;
      const x21 = stretch + 1;
      const x22 = x0*x21 + x20;
      const x23 = -x19*x9 + x22;
      const x24 = mu_D*(d_D - drag_n);
      const x25 = T - x24;
      const x26 = r_S + x13;
      const x27 = x0*(-x11*x26 + x18*x6) + x14;
      const x28 = x11*x25 + x27;
      const x29 = -x0*x8 + x20;
      const x30 = -x21*x3 + x7;
      const x31 = -x19*x29 - x30;
      const x32 = x16*x29 + x28*x31;
      const x33 = x0/T;
      const x34 = mu_D - mu_S;
      const x35 = x0*(x1 + 1);
      const x36 = -x3*x34 + x35;
      const x37 = -x10 + x3;
      const x38 = 1/x37;
      const x39 = -x14;
      const x40 = x38*(x39 + x6);
      const x41 = x36*x40;
      const x42 = x0 + x17;
      const x43 = x38*x42;
      const x44 = x22 - x43*x9;
      const x45 = x0*(-x26*x37 + x42*x6) + x39;
      const x46 = x25*x37 + x45;
      const x47 = -x29*x43 - x30;
      const x48 = x29*x41 + x46*x47;
      const x49 = x3*x34 + x35;
      const x50 = x15*x49;
      const x51 = T + x24;
      const x52 = x11*x51 + x27;
      const x53 = x29*x50 + x31*x52;
      const x54 = x2 + x3*x4;
      const x55 = x40*x54;
      const x56 = x37*x51 + x45;
      const x57 = x29*x55 + x47*x56;
      return [x32 + x33*(rho*x5 - x26*x32 + x6*(x16*x9 + x23*x28)), x33*(rho*x36 - x26*x48 + x6*(x41*x9 + x44*x46)) + x48, x33*(rho*x49 - x26*x53 + x6*(x23*x52 + x50*x9)) + x53, x33*(rho*x54 - x26*x57 + x6*(x44*x56 + x55*x9)) + x57];
    },
    // m^2: positive where D alone, at friction ratio tau, presses if it advances
    stiffness(p_D, d_D, drag_a, drag_n, rho, stretch, shear, tau) {
      return [-rho*(-shear*tau - stretch - 1) + (-drag_a + p_D)*(-drag_a + p_D + tau*(d_D - drag_n))*(-Math.pow(shear, 2) - Math.pow(stretch, 2) + 1)];
    },
    // m^2: positive where D alone presses if it sticks; what the slip grows by per ratio
    pressing(c, s, p_D, d_D, drag_a, drag_n, rho, stretch, shear, bend) {
      const x0 = bend*c + s;
      const x1 = d_D - drag_n;
      const x2 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      return [rho*x0*(1 - stretch) + x0*Math.pow(x1, 2)*x2 + (-bend*s + c)*(rho*shear + x1*x2*(-drag_a + p_D))];
    },
    // m^2: slip towards +a of the part over D that pushes alone without friction, per travel, times the stiffness
    slip_alone(c, s, p_D, d_D, drag_a, drag_n, rho, stretch, shear, bend) {
      const x0 = bend*c + s;
      const x1 = -drag_a + p_D;
      const x2 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      return [rho*shear*x0 + x0*x1*x2*(d_D - drag_n) + (-bend*s + c)*(-rho*(-stretch - 1) + Math.pow(x1, 2)*x2)];
    },
    // friction ratio at which D alone sticks
    stick_ratio(c, s, p_D, d_D, drag_a, drag_n, rho, stretch, shear, bend) {
      const x0 = bend*c + s;
      const x1 = d_D - drag_n;
      const x2 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      const x3 = -bend*s + c;
      const x4 = rho*shear;
      const x5 = -drag_a + p_D;
      const x6 = x1*x2*x5;
      return [(-x0*x4 - x0*x6 - x3*(-rho*(-stretch - 1) + x2*Math.pow(x5, 2)))/(rho*x0*(1 - stretch) + x0*Math.pow(x1, 2)*x2 + x3*(x4 + x6))];
    },
    // how much S's edge closes on S per turn while D alone pushes at friction ratio tau, m
    gap_per_turn(c, s, p_D, V, gap, d_D, d_S, r_D, r_S, kappa, drag_a, drag_n, rho, stretch, shear, tau) {
      const x0 = -drag_a + p_D + tau*(d_D - drag_n);
      const x1 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      const x2 = Math.sin(kappa);
      const x3 = Math.cos(kappa);
      const x4 = 1/(c*x2 + s*x3);
      const x5 = d_S + gap + r_S;
      const x6 = -V - c*(d_D + r_D + x3*x5) + s*(p_D + x2*x5);
      const x7 = x0*x1;
      return [(-x2*(rho*(shear + tau*(1 - stretch)) + x7*(-d_S*x3 - drag_n - x2*x4*x6)) - x3*(rho*(-shear*tau - stretch - 1) - x7*(-d_S*x2 - drag_a + x3*x4*x6)))/(x0*x1)];
    },
    // the same while the contact of D sticks, m
    gap_per_rolling(c, s, p_D, V, gap, d_D, d_S, r_D, r_S, kappa, drag_a, drag_n, rho, stretch, shear, bend) {
      const x0 = Math.cos(kappa);
      const x1 = Math.sin(kappa);
      const x2 = 1/(c*x1 + s*x0);
      const x3 = d_S + gap + r_S;
      const x4 = -V - c*(d_D + r_D + x0*x3) + s*(p_D + x1*x3);
      const x5 = bend*c + s;
      const x6 = bend*s - c;
      const x7 = -x5;
      const x8 = Math.pow(d_D, 2);
      const x9 = Math.pow(drag_a, 2);
      const x10 = Math.pow(drag_n, 2);
      const x11 = Math.pow(p_D, 2);
      const x12 = 2*d_D;
      const x13 = drag_n*x12;
      const x14 = 2*drag_a;
      const x15 = p_D*x14;
      const x16 = shear*x14;
      const x17 = p_D*shear;
      return [x0*(-d_S*x1 - p_D + x0*x2*x4) - x1*(-d_D - d_S*x0 - x1*x2*x4) + (x0*x5 - x1*x6)*(d_D*x16 - drag_n*x16 + 2*drag_n*x17 + rho + stretch*x10 - stretch*x11 - stretch*x13 + stretch*x15 + stretch*x8 - stretch*x9 + x10 + x11 - x12*x17 - x13 - x15 + x8 + x9)/((d_D - drag_n)*(shear*x7 + x6*(stretch + 1)) - (-drag_a + p_D)*(shear*x6 + x7*(1 - stretch)))];
    },
    // turn per travel while D alone pushes and its contact sticks, rad/m
    turn_rolling(c, s, p_D, d_D, drag_a, drag_n, rho, stretch, shear, bend) {
      const x0 = -bend*c - s;
      const x1 = bend*s - c;
      const x2 = Math.pow(d_D, 2);
      const x3 = Math.pow(drag_a, 2);
      const x4 = Math.pow(drag_n, 2);
      const x5 = Math.pow(p_D, 2);
      const x6 = 2*d_D;
      const x7 = drag_n*x6;
      const x8 = 2*drag_a;
      const x9 = p_D*x8;
      const x10 = shear*x8;
      const x11 = p_D*shear;
      return [((d_D - drag_n)*(shear*x0 + x1*(stretch + 1)) - (-drag_a + p_D)*(shear*x1 + x0*(1 - stretch)))/(d_D*x10 - drag_n*x10 + 2*drag_n*x11 + rho + stretch*x2 - stretch*x3 + stretch*x4 - stretch*x5 - stretch*x7 + stretch*x9 - x11*x6 + x2 + x3 + x4 + x5 - x7 - x9)];
    },
    // change of p_D per turn while D alone pushes at friction ratio tau, m; the lever by which it turns the part, positive where it does so counter-clockwise, m
    creep_per_turn(c, s, p_D, d_D, r_D, drag_a, drag_n, rho, stretch, shear, bend, tau) {
      const x0 = bend*c + s;
      const x1 = d_D - drag_n;
      const x2 = -drag_a + p_D + tau*x1;
      const x3 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      const x4 = x0*x2*x3;
      return [(-r_D*x4 - rho*x0*(shear + tau*(1 - stretch)) - x1*x4 - (-bend*s + c)*(-rho*(-shear*tau - stretch - 1) + x2*x3*(-drag_a + p_D)))/(x0*x2*x3), x2];
    },
    // q and T, m, while S's edge is gap away from S and D touches at p_D
    passive_place(c, s, p_D, V, gap, d_D, d_S, r_D, r_S, kappa) {
      const x0 = Math.sin(kappa);
      const x1 = Math.cos(kappa);
      const x2 = d_S + gap + r_S;
      const x3 = p_D + x0*x2;
      const x4 = (-V - c*(d_D + r_D + x1*x2) + s*x3)/(c*x0 + s*x1);
      return [-x4, -x1*x4 + x3];
    },
    // m: positive where two tips on parallel edges, of radii that add up to radii, cannot jam the part; mu is the smaller one of both tips
    no_jam(V, width, radii, mu) {
      const x0 = Math.pow(mu, 2) + 1;
      return [V*Math.sqrt(x0) - radii - width*x0];
    },
  },
  contact_forces: {
    // most that one of two tips on one edge presses on a part while the probe's path has the slope bend against its straight line, over e_x and the speed along that line; with mu = 0: one tip alone, sticking
    carrying_force(stretch, shear, mu, bend) {
      return [Math.sqrt(Math.pow(bend, 2) + 1)*Math.sqrt(Math.pow(mu, 2) + 1)*(Math.sqrt(Math.pow(shear, 2) + Math.pow(stretch, 2)) + 1)];
    },
  },
  y_translation: {
    // m: rise of the centre over tilt and straightening
    gain(theta_0, theta_1, theta_2, d1, d2, d2_back) {
      const x0 = Math.sin(theta_1);
      return [-d1*(Math.cos(theta_0) - Math.cos(theta_2)) + d2*(-x0 + Math.sin(theta_0)) + d2_back*(x0 - Math.sin(theta_2))];
    },
  },
  polygon_edge: {
    // cos and sin of the direction of the edge from (x0, y0) to (x1, y1) in the part frame; vertices counter-clockwise about the centre of drag
    edge_direction(x0, y0, x1, y1) {
      const x2 = -x0 + x1;
      const x3 = -y0 + y1;
      const x4 = Math.pow(Math.pow(x2, 2) + Math.pow(x3, 2), -1/2);
      return [x2*x4, x3*x4];
    },
    // d1 of the edge from (x0, y0) to (x1, y1), then d2 at its first and at its second vertex, m; d1 is positive where the centre of drag is inside of the edge
    edge_offsets(x0, y0, x1, y1) {
      const x2 = Math.pow(Math.pow(-x0 + x1, 2) + Math.pow(-y0 + y1, 2), -1/2);
      const x3 = x0*x1;
      const x4 = y0*y1;
      return [x2*(x0*y1 - x1*y0), x2*(-Math.pow(x0, 2) + x3 + x4 - Math.pow(y0, 2)), x2*(Math.pow(x1, 2) - x3 - x4 + Math.pow(y1, 2))];
    },
    // d2, m, where the straight part of an edge at d1 ends that meets the line at d1_next, turned from it by the exterior angle, in a corner rounded with this radius
    end_offset(d1, d1_next, exterior, rounding) {
      const x0 = 1/Math.sin(exterior);
      const x1 = Math.cos(exterior);
      return [-rounding*x0*(1 - x1) + x0*(-d1*x1 + d1_next)];
    },
  },
  drag_tensor: {
    // m: travel of the tip per radian of the turn while it sticks; theta: of the edge less that of the push; d1, d2 from the centre of drag
    travel_rate(theta, d1, d2, rho, stretch, shear, bend) {
      const x0 = d1*shear;
      const x1 = stretch + 1;
      const x2 = 1 - stretch;
      const x3 = Math.cos(theta);
      const x4 = Math.sin(theta);
      return [(Math.pow(d1, 2)*x1 + Math.pow(d2, 2)*x2 - 2*d2*x0 + rho)/((-bend*x3 + x4)*(d2*x2 - x0) - (bend*x4 + x3)*(d1*x1 - d2*shear))];
    },
    // pressing force, m^2: the tip pushes where it is positive; theta: of the edge less that of the push; d1, d2 from the centre of drag
    normal_force(theta, d1, d2, rho, stretch, shear, bend) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      return [(-bend*x0 + x1)*(Math.pow(d1, 2)*x2 + rho*(1 - stretch)) + (bend*x1 + x0)*(d1*d2*x2 + rho*shear)];
    },
    // mu times the pressing force -+ the force along the edge, same scale, m^2: both positive where the contact sticks
    friction_margin(theta, d1, d2, rho, stretch, shear, bend, mu) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = bend*x1 + x0;
      const x3 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      const x4 = d1*d2*x3 + rho*shear;
      const x5 = -bend*x0 + x1;
      const x6 = x2*x4 + x5*(Math.pow(d1, 2)*x3 + rho*(1 - stretch));
      const x7 = x2*(Math.pow(d2, 2)*x3 + rho*(stretch + 1)) + x4*x5;
      return [mu*x6 + x7, mu*x6 - x7];
    },
    // m: positive where the part turns counter-clockwise (side = 1) or clockwise (-1)
    turning(theta, d1, d2, stretch, shear, bend, side) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      return [side*((-bend*x0 + x1)*(-d1*shear + d2*(1 - stretch)) - (bend*x1 + x0)*(d1*(stretch + 1) - d2*shear))];
    },
    // m^2: both positive where a sticking solution excludes every slipping one
    only_solution(d1, d2, rho, stretch, shear, mu) {
      const x0 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      const x1 = mu*(d1*d2*x0 + rho*shear);
      const x2 = Math.pow(d2, 2)*x0 + rho*(stretch + 1);
      return [x1 + x2, -x1 + x2];
    },
    // m^2: all positive where a contact has one motion, in which it presses and, unless it sticks, the part slides towards a (side = 1) or -a (-1) over the tip
    slips_one_way(theta, d1, d2, rho, stretch, shear, bend, mu, side) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = -bend*x0 + x1;
      const x3 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      const x4 = d1*d2*x3 + rho*shear;
      const x5 = mu*x4;
      const x6 = Math.pow(d2, 2)*x3 + rho*(stretch + 1);
      const x7 = bend*x1 + x0;
      return [x2*(x5 + x6), x2*(-x5 + x6), mu*(x2*(Math.pow(d1, 2)*x3 + rho*(1 - stretch)) + x4*x7) - side*(-x2*x4 - x6*x7)];
    },
    // m^2: positive where a contact that turns the part any way slips that way by less per turn than `slipped` grows, if at all
    creeps_less(theta, d1, d2, rho, stretch, shear, bend, mu, side, creep) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = -bend*x0 + x1;
      const x3 = -Math.pow(shear, 2) - Math.pow(stretch, 2) + 1;
      const x4 = bend*x1 + x0;
      const x5 = d1*d2*x3 + rho*shear;
      return [creep*x2*x3*(-d1*mu + d2*side)*(3*Math.pow(x0, 2)*x1 + (1/256)*x1) + mu*(x2*(Math.pow(d1, 2)*x3 + rho*(1 - stretch)) + x4*x5) + side*(-x2*x5 - x4*(Math.pow(d2, 2)*x3 + rho*(stretch + 1)))];
    },
    // m: how far along a a contact has slipped at most since the edge was at theta_start, both from the push
    slipped(theta, theta_start, creep) {
      const x0 = Math.cos(theta);
      const x1 = Math.cos(theta_start);
      return [creep*(-Math.pow(x0, 3) - 1/256*x0 + Math.pow(x1, 3) + (1/256)*x1)];
    },
    // m: where positive, one contact alone turns the part counter-clockwise (side = 1) or clockwise (-1), whether it sticks or slips
    turns_any_way(d1, d2, mu, side) {
      return [-d1*mu + d2*side];
    },
    // m: where all are positive, one contact alone turns the part counter-clockwise (side = 1) or clockwise (-1), whether it sticks or slips
    turns_back(theta, d1, d2, stretch, shear, bend, mu, side) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = d1*(stretch + 1) - d2*shear;
      return [side*(-x2*(bend*x1 + x0) + (-bend*x0 + x1)*(-d1*shear + d2*(1 - stretch))), d1*mu + d2*side, x2];
    },
    // the first two positive: two tips on one edge stick; the others: no motion slips
    pair_friction(theta, stretch, shear, bend, mu) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = bend*x1 + x0;
      const x3 = -bend*x0 + x1;
      const x4 = shear*x2 + x3*(1 - stretch);
      const x5 = stretch + 1;
      const x6 = shear*x3 + x2*x5;
      const x7 = mu*shear;
      return [mu*x4 + x6, mu*x4 - x6, x5 - x7, x5 + x7];
    },
    // pressing forces of the upper tip, at d2, and of the lower one, gap below it, times the gap, m: both must be positive
    pair_forces(theta, d1, d2, gap, stretch, shear, bend) {
      const x0 = Math.cos(theta);
      const x1 = Math.sin(theta);
      const x2 = bend*x1 + x0;
      const x3 = -bend*x0 + x1;
      const x4 = shear*x2 + x3*(1 - stretch);
      const x5 = d1*(-shear*x3 - x2*(stretch + 1)) + d2*x4;
      return [gap*x4 - x5, x5];
    },
  },
  slot_walls: {
    // what d2 of the tip has to spare, m, for the slot's edge p ahead of the centre to turn back a part that bears on it with its side, half a width from the centre
    bears(d1, d2, p, b, mu, mu_w) {
      const x0 = mu*(-b*mu_w + d1 + p);
      return [d2 - x0, d2 + x0];
    },
    // positive, m^2, where friction at the slot's edge cannot turn the part against the film
    stiff(rho, b, mu_w) {
      return [-Math.pow(b, 2)*Math.pow(mu_w, 2) + 4*rho];
    },
    // positive, m, where the part turns back though no slot's edge holds it; psi: angle between the part and the tip's path
    steers(d1, d2, psi) {
      return [-d1*Math.sin(psi) + d2*Math.cos(psi)];
    },
    // positive, m, where the wall's force on a front corner turns a part back that leans by up to phi; d1: the least distance of its ends from the centre
    corner(d1, b, mu_w, phi) {
      return [-(b + d1*mu_w)*Math.sin(phi) + (-b*mu_w + d1)*Math.cos(phi)];
    },
    // what a slot of width room has to spare, m, for a part that leans by phi not to touch both walls, where its side is within the slot over this length
    one_wall(b, room, engaged, phi) {
      return [-2*b*Math.cos(phi) - engaged*Math.sin(phi) + room];
    },
    // positive where tips and one wall cannot hold the part between them
    no_jam(mu, mu_w, phi) {
      return [-(mu + mu_w)*Math.sin(phi) + (-mu*mu_w + 1)*Math.cos(phi)];
    },
  },
  contact_response: {
    // velocity of the part's point (x, y) where a force (f_x, f_y), over e_x, acts at (x_f, y_f); both from the centre of drag, in axes of the part
    velocity(x, y, x_f, y_f, f_x, f_y, rho, stretch, shear) {
      const x0 = (-f_x*y_f + f_y*x_f)/rho;
      const x1 = 1/(-Math.pow(shear, 2) - Math.pow(stretch, 2) + 1);
      return [-x0*y + x1*(f_x*(1 - stretch) - f_y*shear), x*x0 + x1*(-f_x*shear + f_y*(stretch + 1))];
    },
    // rate of the turn under that force
    turning(x_f, y_f, f_x, f_y, rho) {
      return [(-f_x*y_f + f_y*x_f)/rho];
    },
  },
  dry_sticking: {
    // share of the weight on each support: all positive if the centre is between them
    shares(x_1, y_1, x_2, y_2, x_3, y_3) {
      const x0 = x_2*y_3 - x_3*y_2;
      const x1 = x_1*y_3;
      const x2 = x_1*y_2 - x_2*y_1;
      const x3 = 1/(x0 - x1 + x2 + x_3*y_1);
      return [x0*x3, x3*(-x1 + x_3*y_1), x2*x3];
    },
    // grows with omega and vanishes at the turn per travel of a tip that sticks, m
    moment(theta, d1, d2, omega, x_1, y_1, x_2, y_2, x_3, y_3) {
      const x0 = x_1*y_2 - x_2*y_1;
      const x1 = x_1*y_3;
      const x2 = x_2*y_3 - x_3*y_2;
      const x3 = 1/(x0 - x1 + x2 + x_3*y_1);
      const x4 = -Math.cos(theta);
      const x5 = -d1 + y_3;
      const x6 = omega*x5 + x4;
      const x7 = Math.sin(theta);
      const x8 = -d2 + x_3;
      const x9 = -omega*x8 - x7;
      const x10 = -d1 + y_2;
      const x11 = omega*x10 + x4;
      const x12 = -d2 + x_2;
      const x13 = -omega*x12 - x7;
      const x14 = -d1 + y_1;
      const x15 = omega*x14 + x4;
      const x16 = -d2 + x_1;
      const x17 = -omega*x16 - x7;
      return [x0*x3*(x5*x6 - x8*x9)/Math.sqrt(Math.pow(x6, 2) + Math.pow(x9, 2)) + x2*x3*(x14*x15 - x16*x17)/Math.sqrt(Math.pow(x15, 2) + Math.pow(x17, 2)) + x3*(-x1 + x_3*y_1)*(x10*x11 - x12*x13)/Math.sqrt(Math.pow(x11, 2) + Math.pow(x13, 2))];
    },
    // mu lambda_n -+ lambda_t over all dry friction: both positive where the contact sticks
    friction_margin(theta, d1, d2, omega, x_1, y_1, x_2, y_2, x_3, y_3, mu) {
      const x0 = Math.sin(theta);
      const x1 = -omega*(-d2 + x_1) - x0;
      const x2 = -Math.cos(theta);
      const x3 = omega*(-d1 + y_1) + x2;
      const x4 = x_1*y_3;
      const x5 = x_2*y_3 - x_3*y_2;
      const x6 = x_1*y_2 - x_2*y_1;
      const x7 = 1/(-x4 + x5 + x6 + x_3*y_1);
      const x8 = x5*x7/Math.sqrt(Math.pow(x1, 2) + Math.pow(x3, 2));
      const x9 = -omega*(-d2 + x_2) - x0;
      const x10 = omega*(-d1 + y_2) + x2;
      const x11 = x7*(-x4 + x_3*y_1)/Math.sqrt(Math.pow(x10, 2) + Math.pow(x9, 2));
      const x12 = -omega*(-d2 + x_3) - x0;
      const x13 = omega*(-d1 + y_3) + x2;
      const x14 = x6*x7/Math.sqrt(Math.pow(x12, 2) + Math.pow(x13, 2));
      const x15 = mu*(x1*x8 + x11*x9 + x12*x14);
      const x16 = x10*x11 + x13*x14 + x3*x8;
      return [-x15 - x16, -x15 + x16];
    },
  },
};
