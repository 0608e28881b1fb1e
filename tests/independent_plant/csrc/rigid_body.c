/* Serial recursion in the link angles theta = A q + offset, mapped to the actuators by the transpose of A:
 * the parallelogram makes q3 absolute, theta3 = q3 - q2. */
#include "rigid_body.h"

#include <math.h>
#include <string.h>

#define HALF_PI 1.57079632679489661923

static const double LENGTH_A[6] = {0.0, 0.1, 0.705, 0.135, 0.0, 0.0};
static const double OFFSET_D[6] = {0.615, 0.0, 0.0, 0.755, 0.0, 0.0};
static const double COS_ALPHA[6] = {1.0, 0.0, 1.0, 0.0, 0.0, 0.0};
static const double SIN_ALPHA[6] = {0.0, -1.0, 0.0, -1.0, 1.0, 1.0};
static const double THETA_OFFSET[6] = {0.0, -HALF_PI, 0.0, 0.0, 2.0 * HALF_PI, 0.0};

typedef struct { double c[6], s[6]; } Angles;

static void cross(const Vec a, const Vec b, Vec out) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* R_i^{i-1} = Rot(x, alpha) Rot(z, theta): vector of frame i seen in frame i-1, and back. */
static void to_parent(const Angles *k, int i, const Vec v, Vec out) {
    const double x = k->c[i] * v[0] - k->s[i] * v[1], y = k->s[i] * v[0] + k->c[i] * v[1], z = v[2];
    out[0] = x;
    out[1] = COS_ALPHA[i] * y - SIN_ALPHA[i] * z;
    out[2] = SIN_ALPHA[i] * y + COS_ALPHA[i] * z;
}

static void to_child(const Angles *k, int i, const Vec v, Vec out) {
    const double x = v[0], y = COS_ALPHA[i] * v[1] + SIN_ALPHA[i] * v[2];
    out[2] = -SIN_ALPHA[i] * v[1] + COS_ALPHA[i] * v[2];
    out[0] = k->c[i] * x + k->s[i] * y;
    out[1] = -k->s[i] * x + k->c[i] * y;
}

static void origin(int i, Vec p) { /* origin of frame i in frame i-1 */
    p[0] = LENGTH_A[i];
    p[1] = -SIN_ALPHA[i] * OFFSET_D[i];
    p[2] = COS_ALPHA[i] * OFFSET_D[i];
}

static void inertia_times(const double *I, const Vec w, Vec out) {
    out[0] = I[0] * w[0] + I[3] * w[1] + I[4] * w[2];
    out[1] = I[3] * w[0] + I[1] * w[1] + I[5] * w[2];
    out[2] = I[4] * w[0] + I[5] * w[1] + I[2] * w[2];
}

static void actuators_to_links(const double q[6], double th[6]) {
    memcpy(th, q, 6 * sizeof *th);
    th[2] = q[2] - q[1];
}

static Angles link_angles(const double q[6]) {
    Angles k;
    double th[6];
    actuators_to_links(q, th);
    for (int i = 0; i < 6; i++) {
        k.c[i] = cos(th[i] + THETA_OFFSET[i]);
        k.s[i] = sin(th[i] + THETA_OFFSET[i]);
    }
    return k;
}

/* acc(point) = acc + eps x r + w x (w x r) */
static inline void acceleration_at(const Vec acc, const Vec w, const Vec eps, const Vec r, Vec out) {
    Vec er, wr, wwr;
    cross(eps, r, er);
    cross(w, r, wr);
    cross(w, wr, wwr);
    for (int a = 0; a < 3; a++) out[a] = acc[a] + er[a] + wwr[a];
}

/* Forces f and moments n of the links become what each hands to its parent, and torques of the actuators. */
static void hand_inwards(const Angles *k, Vec f[6], Vec n[6], double tau[6]) {
    double tau_theta[6];
    for (int i = 5; i >= 0; i--) {
        Vec p, force, torque, lever;
        tau_theta[i] = n[i][2];
        if (i == 0) break;
        origin(i, p);
        to_parent(k, i, f[i], force);
        to_parent(k, i, n[i], torque);
        cross(p, force, lever);
        for (int a = 0; a < 3; a++) {
            f[i - 1][a] += force[a];
            n[i - 1][a] += torque[a] + lever[a];
        }
    }
    memcpy(tau, tau_theta, sizeof tau_theta);
    tau[1] -= tau_theta[2];
}

static void newton_euler(const double (*link)[10], const Vec gravity, const Angles *k, const double qd[6],
                         const double qdd[6], double tau[6]) {
    double thd[6], thdd[6];
    Vec w[6], eps[6], f[6], n[6], acc = {-gravity[0], -gravity[1], -gravity[2]};
    Vec w_parent = {0, 0, 0}, eps_parent = {0, 0, 0};
    actuators_to_links(qd, thd);
    actuators_to_links(qdd, thdd);
    for (int i = 0; i < 6; i++) { /* outwards: speeds, accelerations, inertial force and moment of each link */
        const double *m = link[i];
        Vec p, at_origin, at_mass, Iw, gyro, moment;
        origin(i, p);
        acceleration_at(acc, w_parent, eps_parent, p, at_origin);
        to_child(k, i, at_origin, acc);
        to_child(k, i, w_parent, w[i]);
        to_child(k, i, eps_parent, eps[i]);
        eps[i][0] += w[i][1] * thd[i];
        eps[i][1] -= w[i][0] * thd[i];
        eps[i][2] += thdd[i];
        w[i][2] += thd[i];
        acceleration_at(acc, w[i], eps[i], m + 1, at_mass);
        for (int a = 0; a < 3; a++) f[i][a] = m[0] * at_mass[a];
        inertia_times(m + 4, w[i], Iw);
        cross(w[i], Iw, gyro);
        inertia_times(m + 4, eps[i], n[i]);
        cross(m + 1, f[i], moment);
        for (int a = 0; a < 3; a++) n[i][a] += gyro[a] + moment[a];
        memcpy(w_parent, w[i], sizeof(Vec));
        memcpy(eps_parent, eps[i], sizeof(Vec));
    }
    hand_inwards(k, f, n, tau);
}

/* Torques of a unit acceleration of actuator j from rest, without weight: a column of the mass matrix. As newton_euler, without
 * what is zero then: all that is before link j, and all that goes with speeds. */
static void column_of_mass(const double (*link)[10], const Angles *k, int j, double tau[6]) {
    double unit[6] = {0}, thdd[6];
    Vec f[6] = {{0}}, n[6] = {{0}}, acc = {0, 0, 0}, eps = {0, 0, 0};
    unit[j] = 1.0;
    actuators_to_links(unit, thdd);
    for (int i = j; i < 6; i++) {
        const double *m = link[i];
        Vec p, lifted, turned, at_origin, moment;
        origin(i, p);
        cross(eps, p, lifted);
        for (int a = 0; a < 3; a++) at_origin[a] = acc[a] + lifted[a];
        to_child(k, i, at_origin, acc);
        to_child(k, i, eps, turned);
        turned[2] += thdd[i];
        memcpy(eps, turned, sizeof(Vec));
        cross(eps, m + 1, lifted);
        for (int a = 0; a < 3; a++) f[i][a] = m[0] * (acc[a] + lifted[a]);
        inertia_times(m + 4, eps, n[i]);
        cross(m + 1, f[i], moment);
        for (int a = 0; a < 3; a++) n[i][a] += moment[a];
    }
    hand_inwards(k, f, n, tau);
}

/* The rod moves as a point: rho = a1 + r sin(q3 + phi) + s sin q2 from axis 1, height z = r cos(q3 + phi) + s cos q2. */
static void add_rod(const Arm *arm, const double q[6], const double qd[6], double M[6][6], double bias[6]) {
    const double m = arm->rod[0], r = arm->rod[1], phi = arm->rod[2], s = arm->rod[3];
    if (m == 0.0) return;
    const double s2 = s * sin(q[1]), c2 = s * cos(q[1]), s3 = r * sin(q[2] + phi), c3 = r * cos(q[2] + phi);
    const double rho = LENGTH_A[1] + s3 + s2, C1 = cos(q[0]), S1 = sin(q[0]), rate = c2 * qd[1] + c3 * qd[2];
    const double radial[3] = {0, c2, c3}, tangent[3] = {rho, 0, 0}, vertical[3] = {0, -s2, -s3};
    const double *g = arm->gravity;
    const double a_radial = -s2 * qd[1] * qd[1] - s3 * qd[2] * qd[2] - rho * qd[0] * qd[0] - (C1 * g[0] + S1 * g[1]);
    const double a_tangent = 2.0 * rate * qd[0] - (-S1 * g[0] + C1 * g[1]);
    const double a_vertical = -c2 * qd[1] * qd[1] - c3 * qd[2] * qd[2] - g[2];
    for (int i = 0; i < 3; i++) {
        bias[i] += m * (radial[i] * a_radial + tangent[i] * a_tangent + vertical[i] * a_vertical);
        for (int j = 0; j < 3; j++)
            M[i][j] += m * (radial[i] * radial[j] + tangent[i] * tangent[j] + vertical[i] * vertical[j]);
    }
}

void equations_of_motion(const Arm *arm, const double q[6], const double qd[6], double M[6][6], double bias[6]) {
    static const double zero[6];
    const Angles k = link_angles(q);
    newton_euler(arm->link, arm->gravity, &k, qd, zero, bias);
    for (int j = 0; j < 6; j++) {
        double column[6];
        column_of_mass(arm->link, &k, j, column);
        for (int i = 0; i < 6; i++) M[i][j] = column[i];
        M[j][j] += arm->rotor[j];
    }
    add_rod(arm, q, qd, M, bias);
}

void inverse_dynamics(const Arm *arm, const double q[6], const double qd[6], const double qdd[6], double tau[6]) {
    const Angles k = link_angles(q);
    double M[6][6] = {{0}}, bias[6] = {0};
    newton_euler(arm->link, arm->gravity, &k, qd, qdd, tau);
    add_rod(arm, q, qd, M, bias);
    for (int i = 0; i < 6; i++) {
        tau[i] += arm->rotor[i] * qdd[i] + bias[i];
        for (int j = 0; j < 3; j++) tau[i] += M[i][j] * qdd[j];
    }
}

void inverse_dynamics_rows(const Arm *arm, int n, const double q[][6], const double qd[][6],
                           const double qdd[][6], double tau[][6]) {
    for (int k = 0; k < n; k++) inverse_dynamics(arm, q[k], qd[k], qdd[k], tau[k]);
}

/* A unit point mass in a field of that force is pulled just as the tool is. */
void torque_against_force(const double q[6], const Vec point, const Vec force, double tau[6]) {
    static const double zero[6];
    const Angles k = link_angles(q);
    const Vec field = {force[0], force[1], force[2]};
    double link[6][10] = {{0}};
    link[5][0] = 1.0;
    memcpy(&link[5][1], point, sizeof(Vec));
    newton_euler((const double(*)[10])link, field, &k, zero, zero, tau);
}

/* From the tip inwards, frame by frame. */
void tool_tip(const double q[6], Vec tip) {
    static const Vec in_frame_6 = TOOL_TIP;
    const Angles k = link_angles(q);
    memcpy(tip, in_frame_6, sizeof(Vec));
    for (int i = 5; i >= 0; i--) {
        Vec p, turned;
        origin(i, p);
        to_parent(&k, i, tip, turned);
        for (int a = 0; a < 3; a++) tip[a] = p[a] + turned[a];
    }
}

void tool_tips(int n, const double q[][6], Vec tips[]) {
    for (int k = 0; k < n; k++) tool_tip(q[k], tips[k]);
}
