/* Time-optimal x(s) = sdot^2 on a grid, under rows  p u + q x_i <= r  on every cell (u = sddot is constant there).
 *
 * Backward pass: the interval of x_i from which the end can be reached. Forward pass: the largest u at every step.
 * Both ends of the interval come from Newton's method on a convex piecewise linear function, which ends after a few
 * steps (Pham and Pham, A new approach to time-optimal path parameterization, IEEE T-RO 2018, with the two-variable
 * linear programs solved by their convexity).
 */
#include <math.h>
#include <stdint.h>

/* g(x) = (largest lower bound of u) - (smallest upper bound of u), and its slope; u is free to choose where g <= 0 */
static double gap(int64_t rows, const double *line, double x, double *slope)
{
    double upper = 1e300, lower = -1e300, d_upper = 0.0, d_lower = 0.0;
    for (int64_t k = 0; k < rows; k++) {
        const double *l = line + 3 * k;
        const double u = l[1] - l[2] * x;
        if (l[0] > 0.0) {
            if (u < upper) { upper = u; d_upper = -l[2]; }
        } else if (l[0] < 0.0) {
            if (u > lower) { lower = u; d_lower = -l[2]; }
        }
    }
    *slope = d_lower - d_upper;
    return lower - upper;
}

/* the end of { x in [low, high] : g(x) <= 0 } that is nearest to `from` (one of the two); 0 when the set is empty */
static int nearest_end(int64_t rows, const double *line, double low, double high, int from_high, double *result)
{
    double x = from_high ? high : low;
    for (int step = 0; step < 100; step++) {
        double slope;
        const double g = gap(rows, line, x, &slope);
        if (!(g > 0.0)) { *result = x; return 1; }
        if (from_high ? !(slope > 0.0) : !(slope < 0.0)) { return 0; }
        double next = x - g / slope;
        if (from_high ? next < low : next > high) {
            /* rounding at a single point left over */
            if (fabs(next - (from_high ? low : high)) > 1e-12 * (1.0 + fabs(high))) { return 0; }
            next = from_high ? low : high;
        }
        if (next == x) { *result = x; return 1; }
        x = next;
    }
    *result = x;
    return 1;
}

/* Both passes go over the cells first ... last - 1, whose rows the table holds:
 * table [last - first][rows][3] = (p, q, r); of all m cells h [m]; low, high [m + 1] bounds of x; scratch [rows + 2][3];
 * out: reach_low, reach_high [m + 1] the interval of the backward pass, x [m + 1], each with a value where it begins.
 * Returns -1 on success, else the cell that fails. */
int64_t backward(int64_t first, int64_t last, int64_t rows, const double *table, const double *h, const double *low,
                 const double *high, double *scratch, double *reach_low, double *reach_high)
{
    for (int64_t i = last - 1; i >= first; i--) {
        double bottom = low[i], top = high[i];
        int64_t used = 0;
        for (int64_t k = 0; k < rows; k++) {
            const double *row = table + 3 * ((i - first) * rows + k);
            /* a row that hardly depends on u bounds x alone */
            if (fabs(row[0]) * 1e14 <= fabs(row[1]) * h[i] || row[0] == 0.0) {
                if (row[1] > 0.0) { const double v = row[2] / row[1]; if (v < top) { top = v; } }
                else if (row[1] < 0.0) { const double v = row[2] / row[1]; if (v > bottom) { bottom = v; } }
                else if (row[2] < 0.0) { return i; }
                continue;
            }
            double *l = scratch + 3 * used++;
            l[0] = row[0];
            l[1] = row[2] / row[0];
            l[2] = row[1] / row[0];
        }
        const double f = 1.0 / (2.0 * h[i]);
        double *l = scratch + 3 * used++;
        l[0] = 1.0; l[1] = reach_high[i + 1] * f; l[2] = f;
        l = scratch + 3 * used++;
        l[0] = -1.0; l[1] = reach_low[i + 1] * f; l[2] = f;
        if (!(bottom <= top) || !nearest_end(used, scratch, bottom, top, 1, &reach_high[i])
            || !nearest_end(used, scratch, bottom, reach_high[i], 0, &reach_low[i])) {
            return i;
        }
    }
    return -1;
}

int64_t forward(int64_t first, int64_t last, int64_t rows, const double *table, const double *h,
                const double *reach_low, const double *reach_high, double *x)
{
    for (int64_t i = first; i < last; i++) {
        double u = (reach_high[i + 1] - x[i]) / (2.0 * h[i]);
        for (int64_t k = 0; k < rows; k++) {
            const double *row = table + 3 * ((i - first) * rows + k);
            if (row[0] > 0.0 && fabs(row[0]) * 1e14 > fabs(row[1]) * h[i]) {
                const double bound = (row[2] - row[1] * x[i]) / row[0];
                if (bound < u) { u = bound; }
            }
        }
        x[i + 1] = x[i] + 2.0 * h[i] * u;
        if (x[i + 1] < reach_low[i + 1]) { x[i + 1] = reach_low[i + 1]; }
        /* towards rest reach_high is 0 and what is left is the rounding of x[i]: relative to both */
        if (!(x[i + 1] <= reach_high[i + 1] * (1.0 + 1e-9) + x[i] * 1e-12 + 1e-300)) { return i; }
        if (x[i + 1] > reach_high[i + 1]) { x[i + 1] = reach_high[i + 1]; }
    }
    return -1;
}
