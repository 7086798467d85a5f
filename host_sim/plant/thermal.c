/* SPDX-License-Identifier: Apache-2.0 */
#include "plant/thermal.h"

#include <math.h>

/* Powers of the series; beyond a norm of 1 the exponential of a smaller step is squared. */
enum { TERMS = 16, HALVINGS_MAX = 60 };

typedef struct {
    double m[2][2];
} matrix_t;

static matrix_t product(const matrix_t *a, const matrix_t *b)
{
    matrix_t out;
    for (int r = 0; r < 2; r++) {
        for (int c = 0; c < 2; c++) {
            out.m[r][c] = a->m[r][0] * b->m[0][c] + a->m[r][1] * b->m[1][c];
        }
    }
    return out;
}

/* keep = exp(A), mean = sum A^k / (k + 1)!: the mean of exp(A s) for s from 0 to 1, by series. */
static void exponential(const matrix_t *a, matrix_t *keep, matrix_t *mean)
{
    const matrix_t one = {{{1.0, 0.0}, {0.0, 1.0}}};
    matrix_t term = one;
    *keep = one;
    *mean = one;
    for (int k = 1; k < TERMS; k++) {
        term = product(&term, a);
        for (int r = 0; r < 2; r++) {
            for (int c = 0; c < 2; c++) {
                term.m[r][c] /= k;
                keep->m[r][c] += term.m[r][c];
                mean->m[r][c] += term.m[r][c] / (k + 1);
            }
        }
    }
}

/* Of a step twice as long: exp(2A) = exp(A)^2, mean(2A) = (mean(A) + exp(A) mean(A)) / 2. */
static void double_step(matrix_t *keep, matrix_t *mean)
{
    const matrix_t later = product(keep, mean);
    *keep = product(keep, keep);
    for (int r = 0; r < 2; r++) {
        for (int c = 0; c < 2; c++) {
            mean->m[r][c] = 0.5 * (mean->m[r][c] + later.m[r][c]);
        }
    }
}

static double conductance(double k_per_w)
{
    return k_per_w > 0.0 ? 1.0 / k_per_w : 0.0;
}

thermal_t thermal_init(const thermal_row_t *row, double temperature_c, double step_s)
{
    thermal_t out = {.temperature_c = temperature_c,
                     .outer_c = temperature_c,
                     .fixed = row->inner_j_per_k <= 0.0};
    if (out.fixed) {
        return out;
    }
    const bool has_outer = row->outer_j_per_k > 0.0;
    const double inner_w_per_k =
        conductance(row->inner_k_per_w + (has_outer ? 0.0 : row->outer_k_per_w));
    const double outer_w_per_k = conductance(row->outer_k_per_w);
    const double per_inner = 1.0 / row->inner_j_per_k;
    const double per_outer = has_outer ? 1.0 / row->outer_j_per_k : 0.0;
    matrix_t a = {{{-inner_w_per_k * per_inner, has_outer ? inner_w_per_k * per_inner : 0.0},
                   {inner_w_per_k * per_outer, -(inner_w_per_k + outer_w_per_k) * per_outer}}};
    const double fastest = step_s * (fabs(a.m[0][0]) + fabs(a.m[1][1]));
    int halvings = 0;
    while (halvings < HALVINGS_MAX && ldexp(fastest, -halvings) > 1.0) {
        halvings++;
    }
    const double scale = ldexp(step_s, -halvings);
    for (int r = 0; r < 2; r++) {
        for (int c = 0; c < 2; c++) {
            a.m[r][c] *= scale;
        }
    }
    matrix_t keep;
    matrix_t mean;
    exponential(&a, &keep, &mean);
    for (int k = 0; k < halvings; k++) {
        double_step(&keep, &mean);
    }
    for (int r = 0; r < 2; r++) {
        for (int c = 0; c < 2; c++) {
            out.keep[r][c] = keep.m[r][c];
            out.gain_k_per_j[r][c] = mean.m[r][c] * (c == 0 ? per_inner : per_outer);
        }
    }
    return out;
}

void thermal_step(thermal_t *thermal, double inner_j, double outer_j, double ambient_c)
{
    if (thermal->fixed) {
        return;
    }
    const double inner_k = thermal->temperature_c - ambient_c;
    const double outer_k = thermal->outer_c - ambient_c;
    thermal->temperature_c = ambient_c + thermal->keep[0][0] * inner_k +
                             thermal->keep[0][1] * outer_k + thermal->gain_k_per_j[0][0] * inner_j +
                             thermal->gain_k_per_j[0][1] * outer_j;
    thermal->outer_c = ambient_c + thermal->keep[1][0] * inner_k + thermal->keep[1][1] * outer_k +
                       thermal->gain_k_per_j[1][0] * inner_j +
                       thermal->gain_k_per_j[1][1] * outer_j;
}
