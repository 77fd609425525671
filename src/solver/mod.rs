//! Equilibrium of the body at maximum load.

crate::kinds! {
    /// Equilibrium solvers.
    pub enum SolverKind for "model.solver" {
        Multigrid = "multigrid": "conjugate gradients on a matrix-free stencil, preconditioned by crack-aware lattice multigrid",
        Direct = "direct": "sparse Cholesky factorisation, the reference",
    }
}
