/* Cubics in pieces and their derivatives, by Horner's rule; operation by operation what JointPath._gathered in
 * joint_path.py does with arrays, so with the same bits. */
#include <stdint.h>

/* coefficients [4][m][n] of the powers of s - knots [m]; s, piece [k]; out [k][n]. Returns 1 where a number of a piece
 * is none, else 0. */
int on_piece(int64_t k, int64_t m, int64_t n, int64_t order, const double *knots, const double *coefficients,
             const double *s, const int64_t *piece, double *out)
{
    static const double factors[4][4] = {
        { 1.0, 1.0, 1.0, 1.0 }, { 0.0, 1.0, 2.0, 3.0 }, { 0.0, 0.0, 2.0, 6.0 }, { 0.0, 0.0, 0.0, 6.0 }
    };
    const double *f = factors[order];
    for (int64_t i = 0; i < k; i++) {
        const int64_t p = piece[i];
        if (p < 0 || p >= m) { return 1; }
        const double d = s[i] - knots[p];
        for (int64_t j = 0; j < n; j++) {
            double value = f[3] * coefficients[(3 * m + p) * n + j];
            for (int64_t power = 2; power >= order; power--) {
                value = value * d + f[power] * coefficients[(power * m + p) * n + j];
            }
            out[i * n + j] = value;
        }
    }
    return 0;
}
