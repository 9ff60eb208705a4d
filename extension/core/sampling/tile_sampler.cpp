#include "core/sampling/tile_sampler.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/sampling/block_sampler.hpp"
#include "core/sampling/rank.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace thicket {

namespace {

/// The widest block that is resolved at once, in cells: large enough for its margin to be a small part, small
/// enough for its grid to stay in the second-level cache.
constexpr std::int32_t widest_block = 128;

/// The first lattice coordinate whose world position is at or above `world`.
std::int64_t lattice_at_or_above(double world, double unit) {
	auto lattice = static_cast<std::int64_t>(std::floor(world / unit));
	while (static_cast<double>(lattice) * unit < world) {
		++lattice;
	}
	while (static_cast<double>(lattice - 1) * unit >= world) {
		--lattice;
	}
	return lattice;
}

/// The cells that have a lattice point in the rectangle.
CellRect cells_of(const Rect &rect, double unit) {
	const auto first_cell = [unit](double world) {
		return static_cast<std::int32_t>(lattice_at_or_above(world, unit) >> lattice_bits);
	};
	const auto end_cell = [unit](double world) {
		return static_cast<std::int32_t>(((lattice_at_or_above(world, unit) - 1) >> lattice_bits) + 1);
	};
	CellRect cells{{first_cell(rect.min.x), first_cell(rect.min.y)}, {end_cell(rect.max.x), end_cell(rect.max.y)}};
	cells.min = glm::max(cells.min, glm::ivec2(-cell_limit));
	cells.max = glm::min(cells.max, glm::ivec2(cell_limit));
	return cells;
}

double expected_points(const PointSet &set, const Rect &rect) {
	return rect.size().x * rect.size().y * point_density(set);
}

/// As many points as a rectangle nearly never has.
double enough_points(const PointSet &set, const Rect &rect) {
	const double expected = expected_points(set, rect);
	return expected + 4.0 * std::sqrt(expected) + 16.0;
}

Status validate_rect(const PointSet &set, const Rect &rect) {
	for (const double bound : {rect.min.x, rect.min.y, rect.max.x, rect.max.y}) {
		if (!std::isfinite(bound)) {
			return {ErrorCode::not_finite, "rect", bound};
		}
	}
	const glm::dvec2 size = rect.size();
	if (size.x < 0.0 || size.y < 0.0) {
		return {ErrorCode::inverted, "rect", std::min(size.x, size.y)};
	}
	const double limit = lattice_unit(set) * cell_size * cell_limit;
	for (const double bound : {rect.min.x, rect.min.y, rect.max.x, rect.max.y}) {
		if (const Status status = check_range("rect", bound, -limit, limit); !status.ok()) {
			return status;
		}
	}
	const double expected = expected_points(set, rect);
	if (expected > max_points_per_call) {
		return {ErrorCode::too_many_points, "rect", expected};
	}
	return {};
}

} // namespace

struct TileSampler::Workspace {
	explicit Workspace(const SampleMargins &margins) : blocks(margins) {}

	BlockSampler blocks;
	SampleStats stats;

	Status sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points, const Progress &progress);
	void collect(const PointSet &set, const Rect &rect, const CellRect &block, std::vector<SamplePoint> &r_points);
	void count();
	Status too_wide(const PointSet &set) const;
};

void TileSampler::Workspace::collect(
		const PointSet &set, const Rect &rect, const CellRect &block, std::vector<SamplePoint> &r_points) {
	const LevelGrid &grid = blocks.finest();
	const double unit = lattice_unit(set);
	for (std::int32_t y = block.min.y; y < block.max.y; ++y) {
		const std::uint32_t first = grid.index_of({block.min.x, y});
		std::array<std::int32_t, widest_block> columns;
		std::size_t count_of_points = 0;
		for (std::int32_t column = 0; column < block.size().x; ++column) {
			columns[count_of_points] = column;
			count_of_points += grid.point[first + static_cast<std::uint32_t>(column)] != LevelGrid::no_point ? 1 : 0;
		}
		for (std::size_t i = 0; i < count_of_points; ++i) {
			const std::int32_t x = block.min.x + columns[i];
			const std::uint32_t index = first + static_cast<std::uint32_t>(columns[i]);
			const CellPosition position = LevelGrid::position_of(grid.point[index]);
			const std::int64_t lattice_x = std::int64_t{x} * cell_size + position_x(position);
			const std::int64_t lattice_y = std::int64_t{y} * cell_size + position_y(position);
			const glm::dvec2 world(static_cast<double>(lattice_x) * unit, static_cast<double>(lattice_y) * unit);
			if (rect.contains(world)) {
				const std::uint32_t rank = grid.dart[index];
				r_points.push_back({world, pack({set.layer, {x, y}}), rank, level_of_rank(set.levels, rank)});
			}
		}
	}
}

void TileSampler::Workspace::count() {
	stats.retries += blocks.retries();
	stats.workspace_bytes = 0;
	for (const LevelGrid &grid : blocks.levels()) {
		const glm::ivec2 size = grid.cells.size();
		stats.computed += grid.accepted;
		stats.darts += grid.darts;
		stats.squares += grid.squares;
		stats.cells += static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y);
		stats.workspace_bytes += grid.bytes();
	}
}

Status TileSampler::Workspace::too_wide(const PointSet &set) const {
	const glm::dvec2 position = blocks.undecided_cell() * static_cast<double>(cell_size) * lattice_unit(set);
	return {ErrorCode::margin_too_wide, "rect", static_cast<double>(blocks.margin()), {set.seed, set.radius, position}};
}

/// Of valid arguments. Throws std::bad_alloc.
Status TileSampler::Workspace::sample(
		const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points, const Progress &progress) {
	// One piece of memory for all that will come: to grow in the middle of a large call would hold up a cancel.
	r_points.reserve(static_cast<std::size_t>(enough_points(set, rect)));
	r_points.clear();
	stats = {};
	if (rect.empty()) {
		return {};
	}
	const CellRect cells = cells_of(rect, lattice_unit(set));
	const glm::i64vec2 size(glm::max(cells.size(), glm::ivec2(0)));
	const glm::i64vec2 count_of_blocks = (size + std::int64_t{widest_block - 1}) / std::int64_t{widest_block};
	blocks.prepare(set, rank_of);
	const auto corner = [&](const glm::i64vec2 &index) {
		return cells.min + glm::ivec2(size * index / count_of_blocks);
	};
	for (std::int64_t row = 0; row < count_of_blocks.y; ++row) {
		for (std::int64_t column = 0; column < count_of_blocks.x; ++column) {
			const CellRect block{corner({column, row}), corner({column + 1, row + 1})};
			switch (blocks.resolve(block, progress.cancel)) {
				case ResolveResult::done: break;
				case ResolveResult::cancelled: return {ErrorCode::cancelled, "sample", 0.0};
				case ResolveResult::margin_too_small: r_points.clear(); return too_wide(set);
			}
			collect(set, rect, block, r_points);
			count();
			if (progress.report) {
				const auto done = static_cast<double>(row * count_of_blocks.x + column + 1);
				progress.report(done / static_cast<double>(count_of_blocks.x * count_of_blocks.y), r_points.size());
			}
		}
	}
	stats.kept = r_points.size();
	return {};
}

TileSampler::TileSampler(const SampleMargins &margins) : workspace_(std::make_unique<Workspace>(margins)) {}
TileSampler::~TileSampler() = default;
TileSampler::TileSampler(TileSampler &&) noexcept = default;
TileSampler &TileSampler::operator=(TileSampler &&) noexcept = default;

const SampleStats &TileSampler::stats() const { return workspace_->stats; }

Status TileSampler::sample(
		const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points, const Progress &progress) {
	Status status = validate(set);
	if (status.ok()) {
		status = validate_rect(set, rect);
	}
	if (!status.ok()) {
		return status;
	}
	status = guarded("rect", enough_points(set, rect) * sizeof(SamplePoint),
			[&] { return workspace_->sample(set, rect, r_points, progress); });
	if (status.code == ErrorCode::out_of_memory) {
		r_points.clear();
	}
	return status;
}

} // namespace thicket
