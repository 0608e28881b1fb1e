#include "rigid_body.h"

#include <math.h>
#include <string.h>

/* Modified Denavit-Hartenberg numbers of the paper: lengths [m], cosine and sine of the twists,
 * offsets of the angles [rad]. */
static const double LENGTH[6] = {0, 0.1, 0.705, 0.135, 0, 0};
static const double SHIFT[6] = {0.615, 0, 0, 0.755, 0, 0};
static const double COS_TWIST[6] = {1, 0, 1, 0, 0, 0};
static const double SIN_TWIST[6] = {0, -1, 0, -1, 1, 1};
static const double OFFSET[6] = {0, -1.5707963267948966, 0, 0, 3.141592653589793, 0};

void frame_rates(const double q[6], double rates[6]) {
    for (int i = 0; i < 6; i++) rates[i] = q[i];
    rates[2] -= q[1];
}

Posture posture(const double q[6]) {
    Posture at;
    double theta[6];
    for (int i = 0; i < 6; i++) theta[i] = q[i] + OFFSET[i];
    theta[2] -= q[1];
    for (int i = 0; i < 6; i++) {
        const double c = cos(theta[i]), s = sin(theta[i]);
        const double ca = COS_TWIST[i], sa = SIN_TWIST[i];
        const Mat turn = {c, -s, 0, s * ca, c * ca, -sa, s * sa, c * sa, ca};
        memcpy(at.turn[i], turn, sizeof(Mat));
        at.place[i][0] = LENGTH[i];
        at.place[i][1] = -sa * SHIFT[i];
        at.place[i][2] = ca * SHIFT[i];
    }
    return at;
}

void cross(const Vec a, const Vec b, Vec out) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

void turned(const Mat r, const Vec x, Vec out) {
    for (int i = 0; i < 3; i++)
        out[i] = r[3 * i] * x[0] + r[3 * i + 1] * x[1] + r[3 * i + 2] * x[2];
}

void turned_back(const Mat r, const Vec x, Vec out) {
    for (int i = 0; i < 3; i++) out[i] = r[i] * x[0] + r[3 + i] * x[1] + r[6 + i] * x[2];
}

static void product(const Mat a, const Mat b, Mat out) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

static void inertia_times(const Body body, const Vec w, Vec out) {
    out[0] = body[4] * w[0] + body[7] * w[1] + body[8] * w[2];
    out[1] = body[7] * w[0] + body[5] * w[1] + body[9] * w[2];
    out[2] = body[8] * w[0] + body[9] * w[1] + body[6] * w[2];
}

typedef struct { /* of one frame, in its own axes */
    Vec speed, rate, pull; /* angular speed, its rate, acceleration of the origin less gravity */
} Motion;

/* x + dw x r + w x (w x r) */
static void carried(const Motion *m, const Vec arm, const Vec x, Vec out) {
    Vec tangential, w_r, centripetal;
    cross(m->rate, arm, tangential);
    cross(m->speed, arm, w_r);
    cross(m->speed, w_r, centripetal);
    for (int k = 0; k < 3; k++) out[k] = x[k] + tangential[k] + centripetal[k];
}

/* From one frame to the next, which turns about its z. */
static void step_outward(Motion *m, const Mat turn, const Vec place, double rate, double rate2) {
    Vec at_next, w, dw;
    carried(m, place, m->pull, at_next);
    turned_back(turn, at_next, m->pull);
    turned_back(turn, m->speed, w);
    turned_back(turn, m->rate, dw);
    dw[0] += w[1] * rate;
    dw[1] -= w[0] * rate;
    dw[2] += rate2;
    w[2] += rate;
    memcpy(m->speed, w, sizeof(Vec));
    memcpy(m->rate, dw, sizeof(Vec));
}

/* Newton and Euler about the frame's origin: h = m c. */
static void body_needs(const Body body, const Motion *m, Vec force, Vec moment) {
    const double *h = body + 1;
    Vec weight, spin, gyroscopic, turning, lever;
    for (int k = 0; k < 3; k++) weight[k] = body[0] * m->pull[k];
    carried(m, h, weight, force);
    inertia_times(body, m->rate, turning);
    inertia_times(body, m->speed, spin);
    cross(m->speed, spin, gyroscopic);
    cross(h, m->pull, lever);
    for (int k = 0; k < 3; k++) moment[k] = turning[k] + gyroscopic[k] + lever[k];
}

/* What frame i bears from the one beyond it. */
static void hand_inward(const Mat turn, const Vec place, const Vec force, const Vec moment,
                        Vec force_in, Vec moment_in) {
    Vec f, n, lever;
    turned(turn, force, f);
    turned(turn, moment, n);
    cross(place, f, lever);
    for (int k = 0; k < 3; k++) {
        force_in[k] += f[k];
        moment_in[k] += n[k] + lever[k];
    }
}

void rigid_torque(const Body link[6], const Vec gravity, const Posture *at, const double qd[6],
                  const double qdd[6], const double *wrench, double tau[6]) {
    double rate[6], rate2[6];
    Vec force[6], moment[6];
    Motion m = {{0, 0, 0}, {0, 0, 0}, {-gravity[0], -gravity[1], -gravity[2]}};
    frame_rates(qd, rate);
    frame_rates(qdd, rate2);
    for (int i = 0; i < 6; i++) {
        step_outward(&m, at->turn[i], at->place[i], rate[i], rate2[i]);
        body_needs(link[i], &m, force[i], moment[i]);
    }
    if (wrench)
        for (int k = 0; k < 3; k++) {
            force[5][k] -= wrench[k];
            moment[5][k] -= wrench[3 + k];
        }
    for (int i = 5; i >= 0; i--) {
        tau[i] = moment[i][2];
        if (i > 0)
            hand_inward(at->turn[i], at->place[i], force[i], moment[i], force[i - 1],
                        moment[i - 1]);
    }
    tau[1] -= tau[2]; /* the absolute axis 3 again */
}

/* The body as one with that of the frame before it, whose axes and origin it takes. */
static void merge(const Body body, const Mat r, const Vec o, Body into) {
    const double m = body[0];
    const Mat own = {body[4], body[7], body[8], body[7], body[5], body[9], body[8], body[9],
                     body[6]};
    Mat half, inertia;
    Vec h;
    turned(r, body + 1, h);
    product(r, own, half);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            inertia[3 * a + b] = half[3 * a] * r[3 * b] + half[3 * a + 1] * r[3 * b + 1] +
                                 half[3 * a + 2] * r[3 * b + 2];
    const double steiner = m * (o[0] * o[0] + o[1] * o[1] + o[2] * o[2]) +
                           2 * (o[0] * h[0] + o[1] * h[1] + o[2] * h[2]);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            inertia[3 * a + b] +=
                (a == b ? steiner : 0) - m * o[a] * o[b] - o[a] * h[b] - h[a] * o[b];
    into[0] += m;
    for (int k = 0; k < 3; k++) into[1 + k] += h[k] + m * o[k];
    into[4] += inertia[0];
    into[5] += inertia[4];
    into[6] += inertia[8];
    into[7] += inertia[1];
    into[8] += inertia[2];
    into[9] += inertia[5];
}

void mass_matrix(const Body link[6], const Posture *at, double M[6][6]) {
    Body outer[6]; /* all from a frame on to the tool as one body */
    memcpy(outer, link, sizeof(outer));
    for (int i = 5; i > 0; i--) merge(outer[i], at->turn[i], at->place[i], outer[i - 1]);
    for (int i = 0; i < 6; i++) { /* force and moment of a unit acceleration of axis i */
        Vec f = {-outer[i][2], outer[i][1], 0};
        Vec n = {outer[i][8], outer[i][9], outer[i][6]};
        M[i][i] = n[2];
        for (int j = i; j > 0; j--) {
            Vec f_in = {0, 0, 0}, n_in = {0, 0, 0};
            hand_inward(at->turn[j], at->place[j], f, n, f_in, n_in);
            memcpy(f, f_in, sizeof(Vec));
            memcpy(n, n_in, sizeof(Vec));
            M[i][j - 1] = M[j - 1][i] = n[2];
        }
    }
    /* A' M A, where A makes theta3 = q3 - q2 */
    for (int i = 0; i < 6; i++) M[i][1] -= M[i][2];
    for (int j = 0; j < 6; j++) M[1][j] -= M[2][j];
}

void solve(double A[6][6], double b[6]) {
    for (int j = 0; j < 6; j++) {
        for (int k = 0; k < j; k++) A[j][j] -= A[j][k] * A[j][k];
        A[j][j] = sqrt(A[j][j] > 1e-9 ? A[j][j] : 1e-9);
        for (int i = j + 1; i < 6; i++) {
            for (int k = 0; k < j; k++) A[i][j] -= A[i][k] * A[j][k];
            A[i][j] /= A[j][j];
        }
    }
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < i; k++) b[i] -= A[i][k] * b[k];
        b[i] /= A[i][i];
    }
    for (int i = 5; i >= 0; i--) {
        for (int k = i + 1; k < 6; k++) b[i] -= A[k][i] * b[k];
        b[i] /= A[i][i];
    }
}

void frame_6(const Posture *at, Mat turn, Vec place) {
    Mat r = {1, 0, 0, 0, 1, 0, 0, 0, 1}, next;
    Vec o = {0, 0, 0}, x;
    for (int i = 0; i < 6; i++) {
        turned(r, at->place[i], x);
        for (int k = 0; k < 3; k++) o[k] += x[k];
        product(r, at->turn[i], next);
        memcpy(r, next, sizeof(Mat));
    }
    memcpy(turn, r, sizeof(Mat));
    memcpy(place, o, sizeof(Vec));
}
