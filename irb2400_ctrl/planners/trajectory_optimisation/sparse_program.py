"""`sparse_program`: IPOPT for programs made of many alike knots and a cheap coupling between them.

CasADi could differentiate the whole program itself, with directional sweeps over the mapped
dynamics. Here the dense Jacobian and Hessian of a single knot are evaluated for all knots, and
their nonzeros put in place.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.machine_code.build_cache import build_shared
from irb2400_ctrl.errors import ToolMissingError

_OPTIONS = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    # CasADi would differentiate the machine code for it
    "no_nlp_grad": True,
    "ipopt.linear_solver": "mumps",
    "ipopt.tol": 1e-4,
    "ipopt.constr_viol_tol": 1e-4,
    "ipopt.dual_inf_tol": 1.0,
    "ipopt.compl_inf_tol": 1e-4,
    # a looser end leaves a per cent of the duration behind
    "ipopt.acceptable_iter": 0,
    "ipopt.mu_strategy": "adaptive",
    "ipopt.bound_relax_factor": 0.0,
}


def sparse_program(
    knot: ca.Function,
    parameters: Array,
    coupling: ca.Function,
    C: ca.DM,
    size: int,
    iterations: int,
) -> ca.Function:
    """IPOPT with derivatives put together from one knot's, mapped, and those of the coupling.

    Args:
        knot: (variables, parameters, multipliers) -> rows, Jacobian, upper triangle of the Hessian.
        parameters: one column for each knot.
        coupling: all variables -> objective, rows that couple knots.
        C: matrix of all variables that is added to the rows of the knots.
        size: number of all variables, those of the knots first.
        iterations: of IPOPT at most; no clock stops it: the same problem has the same answer.
    """
    knots = parameters.shape[1]
    columns = ca.DM(parameters)
    x = ca.MX.sym("x", size)
    p = ca.MX.sym("p", 0)
    sigma = ca.MX.sym("sigma")
    width = knot.size1_in(0)
    count = knot.numel_out(0)
    w = ca.reshape(x[: knots * width], width, knots)
    mapped = knot.map(knots)
    zero = ca.DM.zeros(count, knots)
    rest = ca.Sparsity(size - knots * width, size - knots * width)

    first, second = _derivatives(coupling, size)
    f, gradient, g_c, J_c = first(x)
    rows, jacobian, _ = mapped(w, columns, zero)
    g = ca.vertcat(g_c, ca.vec(rows) + C @ x)
    blocks = ca.diagcat(*[knot.sparsity_out(1)] * knots)
    J_k = ca.horzcat(ca.MX(blocks, jacobian.nz[:]), ca.MX(count * knots, size - knots * width)) + C
    multipliers = ca.MX.sym("lam", g.numel())
    _, _, H = mapped(w, columns, ca.reshape(multipliers[g_c.numel() :], count, knots))
    H_k = ca.MX(ca.diagcat(*[knot.sparsity_out(2)] * knots, rest), H.nz[:])
    H_c = second(x, sigma, multipliers[: g_c.numel()])
    f_only, _ = coupling(x)
    options: dict[str, Any] = {
        **_OPTIONS,
        "ipopt.max_iter": iterations,
        "grad_f": ca.Function("grad_f", [x, p], [f, gradient], ["x", "p"], ["f", "grad_f_x"]),
        "jac_g": ca.Function(
            "jac_g", [x, p], [g, ca.vertcat(J_c, J_k)], ["x", "p"], ["g", "jac_g_x"]
        ),
        "hess_lag": ca.Function(
            "hess_lag",
            [x, p, sigma, multipliers],
            [H_c + H_k],
            ["x", "p", "lam_f", "lam_g"],
            ["triu_hess_gamma_x_x"],
        ),
    }
    program: dict[str, Any] = {"x": x, "p": p, "f": f_only, "g": g}
    return ca.nlpsol("solver", "ipopt", program, options)


def _derivatives(coupling: ca.Function, size: int) -> tuple[ca.Function, ca.Function]:
    """x -> (objective, its gradient, rows, their Jacobian), and (x, sigma, multipliers) -> upper
    triangle of the Hessian of the Lagrangian."""
    x = ca.SX.sym("x", size)
    f, g = coupling(x)
    multipliers = ca.SX.sym("l", g.numel())
    sigma = ca.SX.sym("sigma")
    hessian, _ = ca.hessian(sigma * f + ca.dot(multipliers, g), x)
    first = ca.Function("first", [x], [f, ca.gradient(f, x), g, ca.jacobian(g, x)])
    second = ca.Function("second", [x, sigma, multipliers], [ca.triu(hessian)])
    return first, second


def machine_code(function: ca.Function) -> ca.Function:
    """The same function from a shared library in the build cache; without a compiler the function
    itself."""
    try:
        return ca.external(function.name(), str(build_shared(_c_text(function), straight=True)))
    except ToolMissingError:
        return function


def _c_text(function: ca.Function) -> str:
    """CasADi's own C text of a function."""
    generator = ca.CodeGenerator(f"{function.name()}.c", {"with_header": False})
    generator.add(function)
    return str(generator.dump())
