#include "core/sampling/tile_sampler.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/sampling/area_cache.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/sampling/block_sampler.hpp"
#include "core/sampling/even_order.hpp"
#include "core/sampling/rank.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

/// Maximum width, in cells, of a block that is resolved as a whole. It is large enough that the
/// margin is a small part of the work, and small enough that the grid fits in the L2 cache.
constexpr std::int32_t widest_block = 128;

/// Returns the smallest lattice coordinate whose world position is at or above `world`.
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

/// Returns the cells that have a lattice point in the rectangle.
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

/// Appends the point of a cell if it lies in the rectangle. The point is constructed in place,
/// because copying a value that was just written in parts would stall the processor.
void add_point(const PointSet &set, const Rect &rect, double unit, glm::ivec2 cell, LevelGrid::PointOffset offset,
		std::uint32_t rank, std::vector<SamplePoint> &r_points) {
	const CellPosition position = LevelGrid::position_of(offset);
	const std::int64_t lattice_x = std::int64_t{cell.x} * cell_size + position_x(position);
	const std::int64_t lattice_y = std::int64_t{cell.y} * cell_size + position_y(position);
	const glm::dvec2 world(static_cast<double>(lattice_x) * unit, static_cast<double>(lattice_y) * unit);
	if (rect.contains(world)) {
		SamplePoint &point = r_points.emplace_back();
		point.position = world;
		point.id = pack({set.layer, {wrapped(cell.x, set.period.x), wrapped(cell.y, set.period.y)}});
		point.rank = rank;
		point.level = level_of_rank(set.levels, rank);
	}
}

double expected_points(const PointSet &set, const Rect &rect) {
	return rect.size().x * rect.size().y * point_density(set);
}

/// Returns an upper estimate of the number of points, which a rectangle almost never exceeds.
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
		return {ErrorCode::inverted, "rect", std::min(size.x, size.y), {}, {}, negative_size};
	}
	const double limit = lattice_unit(set) * cell_size * cell_limit;
	for (const double bound : {rect.min.x, rect.min.y, rect.max.x, rect.max.y}) {
		if (const Status status = check_range("rect", bound, -limit, limit); !status.ok()) {
			return status;
		}
	}
	const double expected = expected_points(set, rect);
	if (expected > max_points_per_call) {
		return Status::too_many_points("rect", expected, max_points_per_call);
	}
	return {};
}

/// The blocks into which a rectangle of cells is divided, in row order.
class BlockRange {
public:
	explicit BlockRange(const CellRect &cells) :
			min_(cells.min), size_(glm::max(cells.size(), glm::ivec2(0))),
			blocks_((size_ + std::int64_t{widest_block - 1}) / std::int64_t{widest_block}) {}

	std::int64_t count() const { return blocks_.x * blocks_.y; }

	CellRect block(std::int64_t index) const {
		const glm::i64vec2 at(index % blocks_.x, index / blocks_.x);
		return {corner(at), corner(at + std::int64_t{1})};
	}

private:
	glm::ivec2 corner(const glm::i64vec2 &at) const { return min_ + glm::ivec2(size_ * at / blocks_); }

	glm::ivec2 min_;
	glm::i64vec2 size_;
	glm::i64vec2 blocks_;
};

/// The state that workers share while each takes one block after another.
struct Shared {
	std::int64_t end = 0;
	std::atomic<std::int64_t> next = 0;
	std::atomic<std::int64_t> done = 0;
	std::atomic<std::uint64_t> points = 0;
};

/// The outcome of a worker.
struct Ended {
	/// Number of the block that failed, or the maximum value.
	std::int64_t block = std::numeric_limits<std::int64_t>::max();
	Status status;
};

} // namespace

struct TileSampler::Workspace {
	explicit Workspace(const SampleMargins &margins, std::shared_ptr<BlockCache> cache = nullptr) :
			margins(margins), cache(std::move(cache)), blocks(margins) {}

	SampleMargins margins;
	std::shared_ptr<BlockCache> cache; ///< The shared cache; may be null.
	BlockSampler blocks;
	EvenOrder even_order;
	SampleStats stats;
	std::vector<std::unique_ptr<Workspace>> others; ///< One workspace per lent thread, kept to reuse memory.

	/// The obstacles of the current call; null if there are none.
	const Obstacles *obstacles = nullptr;
	WindowUse use = WindowUse::separate;

	Status sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points, const Progress &progress,
			CallerThreads *threads);
	Status sample_block(const PointSet &set, const Rect &rect, const CellRect &block, const std::atomic<bool> *cancel,
			std::vector<SamplePoint> &r_points);
	bool take_settled(const PointSet &set, const Rect &rect, const CellRect &cells, const std::atomic<bool> *cancel,
			std::vector<SamplePoint> &r_points);
	bool take_areas(const PointSet &set, const Rect &rect, const CellRect &cells, const std::atomic<bool> *cancel,
			std::vector<SamplePoint> &r_points);
	Status sample_together(const PointSet &set, const Rect &rect, const BlockRange &range, CallerThreads &threads,
			std::vector<SamplePoint> &r_points, const Progress &progress);
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
			const std::uint32_t index = first + static_cast<std::uint32_t>(columns[i]);
			add_point(set, rect, unit, {block.min.x + columns[i], y}, grid.point[index], grid.dart[index], r_points);
		}
	}
}

void TileSampler::Workspace::count() {
	stats.retries += blocks.retries();
	stats.workspace_bytes = blocks.obstacle_bytes();
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

/// Appends the points of a block.
Status TileSampler::Workspace::sample_block(const PointSet &set, const Rect &rect, const CellRect &block,
		const std::atomic<bool> *cancel, std::vector<SamplePoint> &r_points) {
	const bool is_even = set.even_order && set.levels > 1;
	switch (blocks.resolve(is_even ? block.grown(EvenOrder::margin) : block, cancel, obstacles)) {
		case ResolveResult::done: break;
		case ResolveResult::cancelled: return {ErrorCode::cancelled, "sample", 0.0};
		case ResolveResult::margin_too_small: return too_wide(set);
	}
	if (is_even) {
		even_order.visit(blocks.levels(), block, [&](glm::ivec2 cell, std::uint32_t level, std::uint32_t squared) {
			blocks.set_rank(cell, even_rank_of(set.levels, level, squared));
		});
	}
	collect(set, rect, block, r_points);
	count();
	return {};
}

/// Takes the points from cached blocks, and computes the missing blocks for the cache. Returns
/// false, without points, if the window must be sampled directly.
bool TileSampler::Workspace::take_settled(const PointSet &set, const Rect &rect, const CellRect &cells,
		const std::atomic<bool> *cancel, std::vector<SamplePoint> &r_points) {
	const glm::ivec2 size = cells.size();
	// Cached blocks belong to sets without obstacles, in the usual order.
	if (cache == nullptr || obstacles != nullptr || set.even_order || std::min(size.x, size.y) <= 0 ||
			std::max(size.x, size.y) > BlockCache::widest_window(set.levels)) {
		return false;
	}
	SettledWindow window(*cache, set, cells);
	if (!window.served()) {
		return false;
	}
	for (CellRect missing; window.next_missing(missing);) {
		if (blocks.resolve(missing, cancel) != ResolveResult::done) {
			return false; // If the error also occurs in direct sampling, direct sampling reports it.
		}
		count();
		window.settle(blocks.finest());
	}
	// These are the points that direct sampling would return.
	const double unit = lattice_unit(set);
	window.for_each([&](glm::ivec2 cell, const SettledBlock::Point &each) {
		add_point(set, rect, unit, cell, each.offset, each.rank, r_points);
	});
	return true;
}

/// Takes the points from cached areas, and computes the missing areas for the cache. Returns false,
/// without points, if the window must be sampled directly.
bool TileSampler::Workspace::take_areas(const PointSet &set, const Rect &rect, const CellRect &cells,
		const std::atomic<bool> *cancel, std::vector<SamplePoint> &r_points) {
	constexpr std::int32_t limit = cell_limit - SettledArea::part_width;
	const glm::ivec2 size = cells.size();
	if (use != WindowUse::overlapping || cache == nullptr || obstacles != nullptr || set.even_order ||
			std::min(size.x, size.y) <= 0 || std::max(size.x, size.y) > AreaWindow::widest ||
			std::min(cells.min.x, cells.min.y) < -limit || std::max(cells.max.x, cells.max.y) > limit) {
		return false;
	}
	AreaWindow window(cache->areas(), set, cells);
	for (CellRect missing; window.next_missing(missing);) {
		if (blocks.resolve(missing, cancel) != ResolveResult::done) {
			return false; // If the error also occurs in direct sampling, direct sampling reports it.
		}
		count();
		window.settle(blocks.finest());
	}
	// Sampling directly would return the same points in the same order.
	const double unit = lattice_unit(set);
	const BlockRange range(cells);
	for (std::int64_t block = 0; block < range.count(); ++block) {
		window.for_each(range.block(block), [&](glm::ivec2 cell, const SettledArea::Point &each) {
			add_point(set, rect, unit, cell, each.offset, each.rank, r_points);
		});
	}
	return true;
}

/// Samples a few blocks per worker, appends their points in order, and repeats. Working in such
/// batches keeps the number of points that are stored twice small.
Status TileSampler::Workspace::sample_together(const PointSet &set, const Rect &rect, const BlockRange &range,
		CallerThreads &threads, std::vector<SamplePoint> &r_points, const Progress &progress) {
	constexpr std::size_t blocks_each = 16;
	while (others.size() < threads.count()) {
		others.push_back(std::make_unique<Workspace>(margins));
	}
	for (const std::unique_ptr<Workspace> &other : others) {
		other->blocks.prepare(set, rank_of);
		other->obstacles = obstacles;
		other->stats = {};
	}
	std::vector<std::vector<SamplePoint>> parts(blocks_each * (others.size() + 1));
	std::vector<Ended> ended(others.size() + 1);
	Shared shared;
	std::int64_t reported_tiles = 0;
	const auto notify = [&](std::int64_t done, std::uint64_t points) {
		if (progress.report && done > reported_tiles) {
			reported_tiles = done;
			progress.report(static_cast<double>(done) / static_cast<double>(range.count()), points);
		}
	};
	for (std::int64_t first = 0; first < range.count(); first = shared.end) {
		shared.end = std::min(range.count(), first + static_cast<std::int64_t>(parts.size()));
		shared.next = first;
		shared.points = r_points.size();
		threads.run([&](std::size_t index) {
			Workspace &mine = index == 0 ? *this : *others[index - 1];
			std::int64_t block = first;
			const auto work = [&] {
				Status status;
				while (status.ok() && (block = shared.next++) < shared.end) {
					std::vector<SamplePoint> &part = parts[static_cast<std::size_t>(block - first)];
					part.clear();
					status = mine.sample_block(set, rect, range.block(block), progress.cancel, part);
					shared.points += part.size();
					const std::int64_t done = ++shared.done;
					if (index == 0 && status.ok()) {
						notify(done, shared.points);
					}
				}
				return status;
			};
			if (const Status status = guarded("rect", 0.0, work); !status.ok()) {
				ended[index] = {block, status};
				shared.next = shared.end;
			}
		});
		// Blocks are started in order, so a single worker would have failed at this block, too.
		const auto failed = std::ranges::min_element(ended, {}, &Ended::block);
		if (!failed->status.ok()) {
			throw_if_out_of_memory(failed->status);
			return failed->status;
		}
		for (std::int64_t block = first; block < shared.end; ++block) {
			const std::vector<SamplePoint> &part = parts[static_cast<std::size_t>(block - first)];
			r_points.insert(r_points.end(), part.begin(), part.end());
		}
		notify(shared.end, r_points.size());
	}
	for (const std::unique_ptr<Workspace> &other : others) {
		stats.add(other->stats);
	}
	return {};
}

/// Samples a rectangle. The arguments must be valid. Throws std::bad_alloc.
Status TileSampler::Workspace::sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
		const Progress &progress, CallerThreads *threads) {
	// Allocates once for all points, because growing the vector during a large call would delay a
	// cancellation.
	r_points.reserve(static_cast<std::size_t>(enough_points(set, rect)));
	r_points.clear();
	stats = {};
	if (rect.empty()) {
		return {};
	}
	const CellRect cells = cells_of(rect, lattice_unit(set));
	const BlockRange range(cells);
	blocks.prepare(set, rank_of);
	Status status;
	const bool is_together = range.count() > 1 && threads != nullptr && threads->count() > 0;
	if (take_settled(set, rect, cells, progress.cancel, r_points) ||
			(!is_together && take_areas(set, rect, cells, progress.cancel, r_points))) {
		if (progress.report) {
			progress.report(1.0, r_points.size());
		}
	} else if (is_together) {
		// The lent threads produce the same points in the same order.
		status = sample_together(set, rect, range, *threads, r_points, progress);
	} else {
		for (std::int64_t block = 0; status.ok() && block < range.count(); ++block) {
			status = sample_block(set, rect, range.block(block), progress.cancel, r_points);
			if (status.ok() && progress.report) {
				progress.report(static_cast<double>(block + 1) / static_cast<double>(range.count()), r_points.size());
			}
		}
	}
	if (status.code == ErrorCode::margin_too_wide) {
		r_points.clear();
	}
	stats.kept = r_points.size();
	return status;
}

void SampleStats::add(const SampleStats &other) {
	computed += other.computed;
	darts += other.darts;
	squares += other.squares;
	cells += other.cells;
	retries += other.retries;
	workspace_bytes += other.workspace_bytes;
}

TileSampler::TileSampler(const SampleMargins &margins, std::shared_ptr<BlockCache> cache) :
		workspace_(std::make_unique<Workspace>(margins, std::move(cache))) {}
TileSampler::~TileSampler() = default;
TileSampler::TileSampler(TileSampler &&) noexcept = default;
TileSampler &TileSampler::operator=(TileSampler &&) noexcept = default;

const SampleStats &TileSampler::stats() const { return workspace_->stats; }

Status TileSampler::sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
		const Progress &progress, CallerThreads *threads, const Obstacles *obstacles, WindowUse use) {
	Status status = validate(set);
	if (status.ok()) {
		status = validate_rect(set, rect);
	}
	if (!status.ok()) {
		return status;
	}
	workspace_->obstacles = obstacles;
	workspace_->use = use;
	status = guarded("rect", enough_points(set, rect) * sizeof(SamplePoint),
			[&] { return workspace_->sample(set, rect, r_points, progress, threads); });
	if (status.code == ErrorCode::out_of_memory) {
		r_points.clear();
	}
	return status;
}

} // namespace thicket
