// Measures the speed of the tile sampler and of Bridson's method in one run, in points per second
// of CPU time. Covers several tile sizes and levels, each instruction set, and the slowest tiles.
// Prints rows of a Markdown table.
//   bench_sampler [rounds = 9] [seconds a measurement = 0.25]
//   bench_sampler ROUNDS SECONDS counts  only the margin's overhead and the workspace, in half a
//                                        minute
//   bench_sampler ROUNDS SECONDS orders  only the cost of the even order
//   bench_sampler ROUNDS SECONDS alone   only tiles of 64 r, for benchmarks that compare with the
//                                        sampler

#include "tests/bench/common/bridson.hpp"
#include "tests/bench/common/command_line.hpp"
#include "tests/bench/common/plain_bridson.hpp"
#include "tests/bench/common/simd_targets.hpp"
#include "tests/bench/common/timing.hpp"

#include "core/sampling/block_cache.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace thicket::bench {
namespace {

constexpr std::array<int, 4> tile_sizes = {16, 32, 64, 128};

/// Samples a new tile in each call, so that no tile is measured twice. The workspace is kept
/// between calls, as in a game.
class TileWalk {
public:
	TileWalk(int tile_size, std::uint32_t levels) : size_(tile_size), set_{.seed = 1, .levels = levels} {}

	/// Walks in rows as long as a view is wide, with cached blocks.
	TileWalk(int tile_size, std::uint32_t levels, std::shared_ptr<BlockCache> blocks) :
			columns_(1024 / tile_size), size_(tile_size), set_{.seed = 1, .levels = levels},
			sampler_({}, std::move(blocks)) {}

	void order_evenly() { set_.even_order = true; }

	std::size_t next() {
		const glm::dvec2 corner = size_ * glm::dvec2(index_ % columns_, index_ / columns_);
		++index_;
		require(sampler_.sample(set_, {corner, corner + size_}, points_));
		const SampleStats &stats = sampler_.stats();
		computed_ += static_cast<double>(stats.computed);
		kept_ += static_cast<double>(stats.kept);
		retries_ += stats.retries;
		bytes_per_cell_ = static_cast<double>(stats.workspace_bytes) / static_cast<double>(stats.cells);
		return points_.size();
	}

	double overhead() const { return computed_ / kept_; }
	double bytes_per_cell() const { return bytes_per_cell_; }
	double retries_per_tile() const { return retries_ / static_cast<double>(index_); }

private:
	int columns_ = 256;
	double size_;
	PointSet set_;
	TileSampler sampler_;
	std::vector<SamplePoint> points_;
	int index_ = 0;
	double computed_ = 0.0;
	double kept_ = 0.0;
	double retries_ = 0.0;
	double bytes_per_cell_ = 0.0;
};

template <typename Method>
double bridson_rate(Method &method, int tile_size, std::uint64_t &seed, double seconds) {
	static std::vector<glm::vec2> points;
	return rate(seconds, [&] {
		method.sample(glm::vec2(static_cast<float>(tile_size)), seed++, points);
		return points.size();
	});
}

/// Prints the counts of the sampler in a fixed number of tiles. Counts of the timed rounds would
/// not be reproducible, because a faster machine computes more tiles in the same time.
void print_counts(int tile_size, std::uint32_t levels) {
	const int tiles = 4096 * 64 / tile_size;
	TileWalk walk(tile_size, levels);
	for (int tile = 0; tile < tiles; ++tile) {
		walk.next();
	}
	const std::string tile = "tiles of " + std::to_string(tile_size) + " r: ";
	const std::string level = ", L = " + std::to_string(levels);
	print_count(tile + "points computed per point kept" + level, walk.overhead(), "", 3);
	// A tile of 64 radii is a single block, so its cells are those of the workspace.
	if (tile_size == 64) {
		print_count(tile + "workspace per cell" + level, walk.bytes_per_cell(), " bytes", 1);
		print_count(tile + "blocks run again with a wider margin, per tile" + level, walk.retries_per_tile(), "", 4);
	}
}

/// Measures one tile size. All methods take turns within each round, so that disturbances affect
/// them equally.
void compare(int tile_size, const Effort &effort) {
	TileWalk plain_order(tile_size, 1);
	TileWalk four_levels(tile_size, 4);
	PlainBridson plain;
	Bridson tuned;
	std::uint64_t seed = 1;
	Series sampler_rates, level_rates, plain_rates, tuned_rates;
	for (int round = 0; round < effort.rounds; ++round) {
		sampler_rates.add(rate(effort.seconds, [&] { return plain_order.next(); }));
		plain_rates.add(bridson_rate(plain, tile_size, seed, effort.seconds));
		level_rates.add(rate(effort.seconds, [&] { return four_levels.next(); }));
		tuned_rates.add(bridson_rate(tuned, tile_size, seed, effort.seconds));
	}
	const std::string tile = "tiles of " + std::to_string(tile_size) + " r: ";
	print_row(tile + "sampler, L = 1", sampler_rates, 1e-6, " M points/s");
	print_row(tile + "sampler, L = 4", level_rates, 1e-6, " M points/s");
	print_row(tile + "plain Bridson", plain_rates, 1e-6, " M points/s");
	print_row(tile + "tuned Bridson", tuned_rates, 1e-6, " M points/s");
	print_row(tile + "sampler over plain Bridson", sampler_rates / plain_rates, 1.0, " times");
	print_row(tile + "sampler over tuned Bridson", sampler_rates / tuned_rates, 1.0, " times");
}

/// Measures adjacent small tiles, with and without cached blocks.
void compare_kept_blocks(int tile_size, std::uint32_t levels, const Effort &effort) {
	TileWalk with(tile_size, levels, std::make_shared<BlockCache>());
	TileWalk without(tile_size, levels, nullptr);
	Series with_rates, without_rates;
	for (int round = 0; round < effort.rounds; ++round) {
		without_rates.add(rate(effort.seconds, [&] { return without.next(); }));
		with_rates.add(rate(effort.seconds, [&] { return with.next(); }));
	}
	const std::string name =
			"tiles of " + std::to_string(tile_size) + " r in rows, L = " + std::to_string(levels) + ": blocks kept";
	print_row(name, with_rates, 1e-6, " M points/s");
	print_row(name + " over none kept", with_rates / without_rates, 1.0, " times");
}

/// Measures the cost of PointSet::even_order.
void compare_orders(int tile_size, const Effort &effort) {
	TileWalk usual(tile_size, 4);
	TileWalk even(tile_size, 4);
	even.order_evenly();
	Series usual_rates, even_rates;
	for (int round = 0; round < effort.rounds; ++round) {
		usual_rates.add(rate(effort.seconds, [&] { return usual.next(); }));
		even_rates.add(rate(effort.seconds, [&] { return even.next(); }));
	}
	print_row("tiles of " + std::to_string(tile_size) + " r: time in even order over the usual order, L = 4",
			usual_rates / even_rates, 1.0, " times");
}

/// Measures each instruction set on tiles of 64 r with L = 1. They take turns within each round.
void compare_targets(const Effort &effort) {
	const std::vector<SimdTarget> targets = simd_targets();
	std::vector<Series> rates(targets.size());
	TileWalk walk(64, 1);
	for (int round = 0; round < effort.rounds; ++round) {
		for (std::size_t i = 0; i < targets.size(); ++i) {
			const ForcedTarget forced(targets[i]);
			rates[i].add(rate(effort.seconds, [&] { return walk.next(); }));
		}
	}
	for (std::size_t i = 0; i < targets.size(); ++i) {
		print_row("tiles of 64 r: sampler on " + targets[i].name, rates[i], 1e-6, " M points/s");
	}
}

/// Measures the 99.9th percentile of a tile's time, relative to the median. The default effort
/// measures a hundred thousand tiles in total.
void measure_slowest(int tile_size, const Effort &effort) {
	TileWalk walk(tile_size, 1);
	Series slowest;
	for (int round = 0; round < effort.rounds; ++round) {
		Series tiles;
		const double begin = cpu_seconds();
		for (double start = begin; start < begin + 20.0 * effort.seconds;) {
			walk.next();
			const double end = cpu_seconds();
			tiles.add(end - start);
			start = end;
		}
		slowest.add(tiles.quantile(0.999) / tiles.median());
	}
	print_row("tiles of " + std::to_string(tile_size) + " r: p99.9 of a tile's time over the median", slowest, 1.0,
			" times the time");
}

void measure_alone(const Effort &effort) {
	TileWalk walk(64, 1);
	Series rates;
	for (int round = 0; round < effort.rounds; ++round) {
		rates.add(rate(effort.seconds, [&] { return walk.next(); }));
	}
	print_row("the sampler alone", rates, 1e-6, " M points/s", 3);
}

} // namespace
} // namespace thicket::bench

int main(int argument_count, char **arguments) {
	using namespace thicket::bench;
	const Effort effort = effort_of(argument_count, arguments);
	const std::string_view section = argument_count > 3 ? arguments[3] : "";
	if (section == "alone") {
		measure_alone(effort);
		return 0;
	}
	if (section == "orders") {
		for (const int tile_size : {16, 64}) {
			compare_orders(tile_size, effort);
		}
		return 0;
	}
	if (section == "counts") {
		for (const int tile_size : tile_sizes) {
			print_counts(tile_size, 1);
			print_counts(tile_size, 4);
		}
		return 0;
	}
	for (const int tile_size : tile_sizes) {
		compare(tile_size, effort);
	}
	for (const int tile_size : {8, 16}) {
		for (const std::uint32_t levels : {1u, 4u}) {
			compare_kept_blocks(tile_size, levels, effort);
		}
	}
	compare_targets(effort);
	measure_slowest(16, effort);
	measure_slowest(64, effort);
}
