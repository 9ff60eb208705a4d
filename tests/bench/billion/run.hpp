#pragma once

#include "gap_check.hpp"
#include "region.hpp"
#include "seams.hpp"
#include "tile_check.hpp"

#include "core/base/status.hpp"
#include "core/sampling/point_set.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <ctime>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace thicket::bench::billion {

/// The options of a run.
struct RunOptions {
	std::uint64_t seed = 1;
	double points = 1e9;     ///< The minimum number of points, in [1e3, Region::max_points].
	std::int32_t tile = 128; ///< Width of a tile in cells, in [16, 512].
	TileOrder order = TileOrder::rows;
	unsigned threads = 1;    ///< Number of threads, at least 1.
	bool verify = true;      ///< If false, the run only generates and counts points.
	std::uint64_t gaps = 64; ///< One in `gaps` tiles is checked for gaps; 0 for none.

	PointSet set() const { return {.seed = seed, .radius = cell_meter_radius}; }
	Region region() const { return Region::holding(points, tile); }
};

/// CPU time in seconds, summed over all threads.
struct Spent {
	double sampling = 0.0;
	double checking = 0.0; ///< Time for everything except the gap checks.
	double gaps = 0.0;
};

/// The result of a run.
struct Outcome {
	/// The first error of a source. After an error, the other fields are incomplete.
	Status status;
	Findings found;
	GapFindings gaps;
	std::uint64_t tiles_finished = 0;
	std::uint64_t tiles_repeated = 0;
	/// The maximum number of points kept at once at the borders of unfinished tiles.
	std::size_t max_rim_points = 0;
	double coverage = 0.0;
	double coverage_error = 0.0; ///< The standard error, from the blocks of the region.
	Spent spent;
	double seconds = 0.0; ///< Wall time in seconds.
};

/// Generates a region tile by tile on several threads, and checks the tiles as they are finished.
class Run {
public:
	/// Prepares the run. Each thread calls `make_source` once.
	Run(const RunOptions &options, std::function<TileSource()> make_source) :
			options_(options), region_(options.region()), sequence_(region_, options.order, options.seed),
			make_source_(std::move(make_source)), seams_(region_),
			block_points_(Region::blocks_per_side * Region::blocks_per_side) {}

	/// Blocks until everything is done. About once per second, calls `progress` on this thread with
	/// the number of points so far.
	Outcome go(const std::function<void(std::uint64_t points)> &progress) {
		const auto start = std::chrono::steady_clock::now();
		std::vector<std::thread> threads;
		for (unsigned i = 0; i < options_.threads; ++i) {
			threads.emplace_back([this] { work(); });
		}
		{
			std::unique_lock lock(mutex_);
			while (!all_idle_.wait_for(lock, std::chrono::seconds(1), [&] { return idle_ == options_.threads; })) {
				progress(points_);
			}
		}
		for (std::thread &thread : threads) {
			thread.join();
		}
		outcome_.tiles_finished = seams_.finished();
		outcome_.tiles_repeated = seams_.repeated();
		outcome_.max_rim_points = seams_.max_kept();
		measure_coverage();
		outcome_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
		return outcome_;
	}

private:
	/// The data and findings of one thread.
	struct Worker {
		TileSource source;
		std::vector<SamplePoint> points;
		TileCheck check;
		GapCheck gap_check;
		Findings found;
		GapFindings gaps;
		Spent spent;
		std::vector<std::uint64_t> block_points;
	};

	RunOptions options_;
	Region region_;
	TileSequence sequence_;
	std::function<TileSource()> make_source_;
	Seams seams_;
	std::atomic<std::uint64_t> next_slot_ = 0;
	std::atomic<std::uint64_t> points_ = 0;
	std::atomic<bool> stop_ = false;

	std::mutex mutex_; ///< Guards all members below.
	std::condition_variable all_idle_;
	unsigned idle_ = 0;
	Outcome outcome_;
	std::vector<std::uint64_t> block_points_;

	static double thread_seconds() {
		std::timespec time{};
		clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
		return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
	}

	void work() {
		Worker worker;
		worker.source = make_source_();
		worker.block_points.resize(block_points_.size());
		Status status;
		for (std::uint64_t slot = next_slot_++; status.ok() && !stop_ && slot < sequence_.slots();
				slot = next_slot_++) {
			if (const std::optional<glm::ivec2> tile_position = sequence_.at(slot)) {
				status = make_tile(*tile_position, worker);
			}
		}
		const std::lock_guard lock(mutex_);
		if (!status.ok()) {
			stop_ = true;
			outcome_.status = status;
		}
		outcome_.found += worker.found;
		outcome_.gaps += worker.gaps;
		outcome_.spent.sampling += worker.spent.sampling;
		outcome_.spent.checking += worker.spent.checking;
		outcome_.spent.gaps += worker.spent.gaps;
		for (std::size_t i = 0; i < block_points_.size(); ++i) {
			block_points_[i] += worker.block_points[i];
		}
		++idle_;
		all_idle_.notify_one();
	}

	Status make_tile(glm::ivec2 tile_position, Worker &r_worker) {
		const double start = thread_seconds();
		const CellRect cells = region_.tile_cells(tile_position);
		if (const Status status = r_worker.source(world_rect(cells), r_worker.points); !status.ok()) {
			return status;
		}
		points_ += r_worker.points.size();
		const double sampled = thread_seconds();
		r_worker.spent.sampling += sampled - start;
		count_blocks(cells, r_worker);
		if (!options_.verify) {
			r_worker.found.points += r_worker.points.size();
			seams_.finish(tile_position, {});
			return {};
		}
		const Findings findings = r_worker.check.take(cells, options_.set().layer, r_worker.points);
		r_worker.found += findings;
		for (const auto &rim : seams_.finish(tile_position, r_worker.check.rim())) {
			r_worker.check.compare_with(*rim, r_worker.found);
		}
		const double checked = thread_seconds();
		r_worker.spent.checking += checked - sampled;
		if (!is_drawn(region_.index_of(tile_position), options_.seed, options_.gaps)) {
			return {};
		}
		const Status status = r_worker.gap_check.take(r_worker.check, findings.digest, r_worker.source, r_worker.gaps);
		r_worker.spent.gaps += thread_seconds() - checked;
		return status;
	}

	void count_blocks(const CellRect &cells, Worker &r_worker) const {
		const std::uint32_t first = region_.block_of(cells.min);
		if (first == region_.block_of(cells.max - 1)) {
			r_worker.block_points[first] += r_worker.points.size();
			return;
		}
		for (const SamplePoint &point : r_worker.points) {
			const glm::ivec2 cell = glm::clamp(glm::ivec2(glm::floor(point.position)), cells.min, cells.max - 1);
			++r_worker.block_points[region_.block_of(cell)];
		}
	}

	/// Computes the coverage and its standard error. The blocks are so large that their common
	/// borders are negligible, so their numbers of points are treated as independent.
	void measure_coverage() {
		const auto blocks = static_cast<double>(block_points_.size());
		const double cells = static_cast<double>(region_.block_side()) * region_.block_side();
		double sum = 0.0;
		for (const std::uint64_t points : block_points_) {
			sum += Region::coverage(static_cast<double>(points), cells);
		}
		outcome_.coverage = sum / blocks;
		double squares = 0.0;
		for (const std::uint64_t points : block_points_) {
			const double error = Region::coverage(static_cast<double>(points), cells) - outcome_.coverage;
			squares += error * error;
		}
		outcome_.coverage_error = std::sqrt(squares / (blocks - 1.0) / blocks);
	}
};

} // namespace thicket::bench::billion
