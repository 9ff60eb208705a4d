// Measures the cost of deciding which tiles to generate, show and drop: the CPU time of a frame's
// decisions, without generating tiles. Prints rows of a Markdown table.
//   bench_streamer [frames = 3000]

#include "tests/bench/common/timing.hpp"

#include "core/streaming/tile_streamer.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string>
#include <vector>

namespace thicket::bench {
namespace {

constexpr double frames_a_second = 60.0;
constexpr std::size_t max_pending = 64;
constexpr std::size_t finished_per_frame = 40;

/// Returns twelve layers as in a large game, from nearby grass to forests on the horizon.
std::vector<StreamLayer> many_layers() {
	std::vector<StreamLayer> layers;
	for (const double tile : {8.0, 16.0, 32.0, 64.0}) {
		for (const double reach : {8.0, 12.0, 20.0}) {
			layers.push_back({tile, tile * reach});
		}
	}
	return layers;
}

std::vector<Viewer> viewers_at(double seconds, double speed, std::size_t count) {
	std::vector<Viewer> viewers;
	for (std::size_t i = 0; i < count; ++i) {
		const double heading = 0.7 + static_cast<double>(i);
		const double from = 400.0 * static_cast<double>(i);
		viewers.push_back({{from + speed * seconds * std::cos(heading), speed * seconds * std::sin(heading)}});
	}
	return viewers;
}

/// Simulates a flight during which a few tiles per frame are finished, in order. If `teleport` is
/// true, the viewers jump far away twice a second. Returns the microseconds of each frame.
Series fly(double speed, std::size_t count, std::size_t frames, bool teleport) {
	TileStreamer streamer;
	(void)streamer.set_layers(many_layers()).ok();
	std::deque<TileRequest> pending;
	StreamChanges changes;
	Series micros;
	for (std::size_t frame = 0; frame < frames; ++frame) {
		const double seconds = static_cast<double>(frame) / frames_a_second;
		std::vector<Viewer> viewers = viewers_at(seconds, speed, count);
		for (Viewer &viewer : viewers) {
			viewer.position.x += teleport ? 1e5 * static_cast<double>(frame / 30) : 0.0;
		}
		const double start = cpu_seconds();
		(void)streamer.update(viewers, max_pending, changes).ok();
		for (std::size_t finished_count = 0; finished_count < finished_per_frame && !pending.empty();
				++finished_count) {
			(void)streamer.finish(pending.front());
			pending.pop_front();
		}
		micros.add(1e6 * (cpu_seconds() - start));
		pending.insert(pending.end(), changes.request.begin(), changes.request.end());
	}
	return micros;
}

void print(const std::string &label, const Series &series) {
	std::printf("| %s: a frame's decisions, 12 layers | %.0f µs, p99 %.0f µs | %.0f to %.0f µs | %zu frames |\n",
			label.c_str(), series.median(), series.quantile(0.99), series.quantile(0.0), series.quantile(1.0),
			series.rounds());
}

} // namespace
} // namespace thicket::bench

int main(int argc, char **argv) {
	using namespace thicket::bench;
	const std::size_t frames = argc > 1 ? static_cast<std::size_t>(std::atoi(argv[1])) : 3000;
	print("flight at 100 m/s", fly(100.0, 1, frames, false));
	print("flight at 1000 m/s", fly(1000.0, 1, frames, false));
	print("two teleports per second", fly(0.0, 1, frames, true));
	print("16 players at 10 m/s", fly(10.0, 16, frames, false));
	return 0;
}
