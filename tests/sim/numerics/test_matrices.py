import numpy as np
import pytest

from sim.numerics import matrices


@pytest.fixture
def draw():
    return np.random.default_rng(5)


def test_products_solutions_and_inverses_are_those_of_linear_algebra(draw):
    for n in (1, 2, 3, 6):
        a, b = draw.uniform(-3, 3, (n, n)), draw.uniform(-3, 3, (n, 2))
        assert matrices.product(a, b) == pytest.approx(a @ b)
        assert matrices.solution(a, b) == pytest.approx(np.linalg.solve(a, b))
        assert matrices.inverse(a) == pytest.approx(np.linalg.inv(a))


def test_a_zero_on_the_diagonal_is_no_obstacle():
    swap = np.array([[0.0, 1.0], [1.0, 0.0]])
    assert (matrices.inverse(swap) == swap).all()


def test_a_singular_matrix_has_no_solution():
    assert np.isnan(matrices.inverse(np.array([[1.0, 2.0], [2.0, 4.0]]))).all()


def test_damping_adds_its_part_of_the_diagonals_mean_and_bears_directions_without_information(draw):
    jacobian, right = draw.uniform(-1, 1, (5, 3)), draw.uniform(-1, 1, (3, 1))
    normal = jacobian.T @ jacobian
    expected = np.linalg.solve(normal + 0.1 * np.trace(normal) / 3 * np.eye(3), right)
    assert matrices.damped_solution(normal, right, 0.1) == pytest.approx(expected, rel=1e-6)
    corridor = np.diag((0.0, 4.0, 1.0))
    assert matrices.damped_solution(corridor, np.array([[0.0], [4.0], [1.0]]), 0.0).ravel() == pytest.approx(
        (0, 1, 1), abs=1e-6
    )


def test_roots_multiply_to_the_covariance(draw):
    factor = draw.uniform(-1, 1, (3, 3))
    for covariance in (factor @ factor.T, np.diag((4.0, 0.0, 0.25)), np.zeros((3, 3)), np.ones((3, 3))):
        root = matrices.root(covariance)
        assert root @ root.T == pytest.approx(covariance)
        assert (np.triu(root, 1) == 0).all()


def test_covariances_of_rows_are_about_their_mean(draw):
    rows = draw.uniform(-1, 1, (50, 3)) + 100.0
    assert matrices.covariance_of(rows) == pytest.approx(np.cov(rows.T, bias=True))
