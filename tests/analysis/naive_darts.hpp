#pragma once

#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace thicket::analysis {

inline constexpr std::uint64_t max_progressive_levels = 16;

/// Naive dart throwing on a square torus until the set is maximal. All lengths are in radii. Its
/// sets are the reference for the sampler's statistics. It shares no code, random numbers or
/// lattice with the sampler.
///
/// It first throws darts at the whole domain. Then it keeps a list of equal squares that covers all
/// uncovered positions, and throws darts uniformly at those squares. After each batch, it splits
/// every square in four and drops the parts that lie within the disk of one point. A dart outside
/// the listed squares would be rejected anyway. Skipping such darts does not change the probability
/// of any accepted dart, so the set is distributed as in naive dart throwing. The process ends when
/// the list is empty, or after 40 splits of the squares.
class NaiveDarts {
public:
	/// Returns the phase of the grid cell with the center `middle`, for `run_in_phases`.
	using PhaseOf = int (*)(glm::dvec2 middle);

	/// `side` is in radii and must be at least 8, so that a disk does not overlap itself. Any seed
	/// is valid. Call only one of the `run` functions, and only once.
	NaiveDarts(double side, std::uint64_t seed) :
			side_(side), columns_(static_cast<int>(std::floor(side * std::sqrt(2.0))) + 1), cell_(side / columns_),
			random_(seed), points_of_cell_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(columns_),
								   {nowhere, nowhere}) {}

	/// Returns the maximal set, in the order of acceptance.
	std::vector<glm::dvec2> run() {
		throw_at_domain();
		fill(all_cells());
		return std::move(points_);
	}

	/// Returns a maximal set that starts with the points `earlier`. They must lie on the torus and
	/// keep the minimum distance.
	std::vector<glm::dvec2> run_after(std::vector<glm::dvec2> fixed_points) {
		for (const glm::dvec2 point : fixed_points) {
			cell(cell_of(point.x), cell_of(point.y)) = point;
		}
		points_ = std::move(fixed_points);
		return run();
	}

	/// Fills the cells of phase 0 completely, then those of phase 1, and so on. The result differs
	/// from dart throwing, and a good statistical test must detect that.
	std::vector<glm::dvec2> run_in_phases(int phases, PhaseOf phase_of) {
		for (int phase = 0; phase < phases; ++phase) {
			std::vector<glm::dvec2> squares = all_cells();
			std::erase_if(squares, [&](glm::dvec2 corner) { return phase_of(corner + 0.5 * cell_) != phase; });
			fill(std::move(squares));
		}
		return std::move(points_);
	}

private:
	static constexpr double nowhere = -1e9;
	static constexpr int reach = 2;
	static constexpr double throws_per_area = 4.0;
	static constexpr int max_splits = 40;

	double side_;
	int columns_;
	double cell_; ///< Slightly less than 1 / sqrt(2), so that a cell contains at most one point.
	std::mt19937_64 random_;
	std::vector<glm::dvec2> points_of_cell_;
	std::vector<glm::dvec2> points_;

	double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }

	int cell_of(double coordinate) const { return std::min(static_cast<int>(coordinate / cell_), columns_ - 1); }

	glm::dvec2 &cell(int x, int y) {
		const auto wrap = [&](int i) {
			return static_cast<std::size_t>((i + columns_) % columns_);
		};
		return points_of_cell_[wrap(y) * static_cast<std::size_t>(columns_) + wrap(x)];
	}

	double shortest(double difference) const { return std::abs(difference - side_ * std::round(difference / side_)); }

	void try_dart(glm::dvec2 dart) {
		const int column = cell_of(dart.x);
		const int row = cell_of(dart.y);
		for (int y = row - reach; y <= row + reach; ++y) {
			for (int x = column - reach; x <= column + reach; ++x) {
				const glm::dvec2 point = cell(x, y);
				const double dx = shortest(point.x - dart.x);
				const double dy = shortest(point.y - dart.y);
				if (point.x != nowhere && dx * dx + dy * dy < 1.0) {
					return;
				}
			}
		}
		cell(column, row) = dart;
		points_.push_back(dart);
	}

	void throw_at_domain() {
		const auto throws = static_cast<std::int64_t>(throws_per_area * side_ * side_);
		for (std::int64_t i = 0; i < throws; ++i) {
			const double x = side_ * unit();
			try_dart({x, side_ * unit()});
		}
	}

	std::vector<glm::dvec2> all_cells() const {
		std::vector<glm::dvec2> corners;
		for (int y = 0; y < columns_; ++y) {
			for (int x = 0; x < columns_; ++x) {
				corners.emplace_back(x * cell_, y * cell_);
			}
		}
		return corners;
	}

	/// Returns true if the square [corner, corner + width) lies within the disk of one point.
	bool covered(glm::dvec2 corner, double width) {
		const glm::dvec2 middle = corner + 0.5 * width;
		const int column = cell_of(middle.x);
		const int row = cell_of(middle.y);
		for (int y = row - reach; y <= row + reach; ++y) {
			for (int x = column - reach; x <= column + reach; ++x) {
				const glm::dvec2 point = cell(x, y);
				const double dx = shortest(point.x - middle.x) + 0.5 * width;
				const double dy = shortest(point.y - middle.y) + 0.5 * width;
				if (point.x != nowhere && dx * dx + dy * dy < 1.0) {
					return true;
				}
			}
		}
		return false;
	}

	void fill(std::vector<glm::dvec2> squares) {
		double width = cell_;
		for (int split_count = 0; split_count < max_splits; ++split_count) {
			std::erase_if(squares, [&](glm::dvec2 corner) { return covered(corner, width); });
			if (squares.empty()) {
				return;
			}
			std::uniform_int_distribution<std::size_t> pick(0, squares.size() - 1);
			for (std::size_t i = 0; i < squares.size(); ++i) {
				const glm::dvec2 corner = squares[pick(random_)];
				const double x = corner.x + width * unit();
				try_dart({std::min(x, std::nextafter(side_, 0.0)),
						std::min(corner.y + width * unit(), std::nextafter(side_, 0.0))});
			}
			width *= 0.5;
			split_all(squares, width);
		}
	}

	void split_all(std::vector<glm::dvec2> &r_squares, double width) {
		std::vector<glm::dvec2> children;
		children.reserve(4 * r_squares.size());
		for (const glm::dvec2 corner : r_squares) {
			for (int child = 0; child < 4; ++child) {
				const glm::dvec2 child_corner = corner + width * glm::dvec2(child & 1, child >> 1);
				if (!covered(child_corner, width)) {
					children.push_back(child_corner);
				}
			}
		}
		r_squares = std::move(children);
	}
};

/// Builds a progressive set by naive dart throwing: a maximal set with the radius 2^(levels - 1),
/// extended to a maximal set with half that radius, and so on down to 1. `side` / 2^(levels - 1)
/// must be a valid side of NaiveDarts.
inline std::vector<glm::dvec2> naive_progressive(double side, std::uint32_t levels, std::uint64_t seed) {
	std::vector<glm::dvec2> points;
	for (std::uint32_t level = levels; level-- > 0;) {
		const double radius = static_cast<double>(1u << level);
		for (glm::dvec2 &point : points) {
			point /= radius;
		}
		points = NaiveDarts(side / radius, seed * max_progressive_levels + level).run_after(std::move(points));
		for (glm::dvec2 &point : points) {
			point *= radius;
		}
	}
	return points;
}

} // namespace thicket::analysis
