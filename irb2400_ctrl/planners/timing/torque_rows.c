/* The rows  p u + q x_i <= r  that keep the torque of every joint within its limits, of arms without effects beside
 * the regular form; operation by operation what torque_constraints.py does with arrays, so with the same bits.
 *
 * a, b, e, c_low, c_high [m][3][n] parabolas (Bernstein); h, x_bar, x_high [m]; top, bottom, rest [m][n] dry friction
 * and remainders; held [m][2][n] above and below; limit [n]; share of the limits to use.
 * Written: the first 8 n of `rows` rows of every cell, table [m][rows][3].
 */
#include <math.h>
#include <stdint.h>

void torque_rows(int64_t m, int64_t n, int64_t rows, const double *a, const double *b, const double *e,
                 const double *c_low, const double *c_high, const double *h, const double *x_bar, const double *x_high,
                 const double *top, const double *bottom, const double *rest, const double *held, const double *limit,
                 const double *share, double *table)
{
    for (int64_t i = 0; i < m; i++) {
        const double root = sqrt(x_bar[i]);
        const double chord = 1.0 / sqrt(x_high[i] < 1e-30 ? 1e-30 : x_high[i]);
        const double twice = 2.0 * h[i];
        for (int side = 0; side < 2; side++) {
            const double sign = side ? -1.0 : 1.0;
            for (int64_t j = 0; j < n; j++) {
                double A[3], B[3], C[3], E[3];
                int helps = 1;
                for (int k = 0; k < 3; k++) {
                    E[k] = sign * e[(3 * i + k) * n + j];
                    helps = helps && E[k] <= 0.0;
                }
                for (int k = 0; k < 3; k++) {
                    const int64_t at = (3 * i + k) * n + j;
                    /* what is no number stays none */
                    const double pushing = E[k] <= 0.0 ? 0.0 : E[k];
                    A[k] = sign * a[at];
                    B[k] = sign * b[at] + pushing / (2.0 * root) + (helps ? E[k] : 0.0) * chord;
                    C[k] = (side ? -c_low[at] : c_high[at]) + pushing * root / 2.0;
                }
                const double dry = side ? -bottom[i * n + j] : top[i * n + j];
                const double reserve = dry + rest[i * n + j] + held[(2 * i + side) * n + j];
                const double p[4] = {
                    A[0],
                    (A[0] + 2.0 * A[1]) / 3.0 + twice * (B[0] / 3.0),
                    (2.0 * A[1] + A[2]) / 3.0 + twice * (2.0 * B[1] / 3.0),
                    A[2] + twice * (3.0 * B[2] / 3.0),
                };
                const double q[4] = { B[0], (B[0] + 2.0 * B[1]) / 3.0, (2.0 * B[1] + B[2]) / 3.0, B[2] };
                const double c[4] = { C[0], (C[0] + 2.0 * C[1]) / 3.0, (2.0 * C[1] + C[2]) / 3.0, C[2] };
                for (int k = 0; k < 4; k++) {
                    double *row = table + 3 * (i * rows + (4 * side + k) * n + j);
                    row[0] = p[k] / limit[j];
                    row[1] = q[k] / limit[j];
                    row[2] = (limit[j] * *share - c[k] - reserve) / limit[j];
                }
            }
        }
    }
}
