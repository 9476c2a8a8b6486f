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
