// Measures the cost of a rule's density per point: a painted mask, an image, clumps and a curve, at
// the points of a layer in tile order. Prints rows of a Markdown table.
//   bench_fields [rounds = 9] [seconds a measurement = 0.25]

#include "tests/bench/common/command_line.hpp"
#include "tests/bench/common/contest.hpp"

#include "core/rules/clump_noise.hpp"
#include "core/rules/curve_table.hpp"
#include "core/rules/image_mask.hpp"
#include "core/rules/painted_mask.hpp"

#include <random>
#include <string>
#include <vector>

namespace thicket::bench {
namespace {

/// Returns a mask with strokes all over the tile, with pixels of 1 m.
PaintedMask painted() {
	PaintedMask mask;
	Rect changed_rect;
	require(mask.reset(1.0, 0.0));
	for (int i = 0; i < 200; ++i) {
		require(mask.paint({.center = {100.0 + i * 37 % 200, -300.0 + i * 61 % 200}, .radius = 15.0}, changed_rect));
	}
	return mask;
}

ImageMask image() {
	ImageMask mask;
	std::mt19937 random(1);
	std::vector<std::uint8_t> pixels(1024 * 1024);
	for (std::uint8_t &pixel : pixels) {
		pixel = static_cast<std::uint8_t>(random());
	}
	require(mask.set({1024, 1024}, pixels, {{-500.0, -500.0}, {500.0, 500.0}}, MaskEdge::repeat));
	return mask;
}

void run(const Effort &effort) {
	const std::vector<glm::dvec2> at = points_of({{100.0, -300.0}, {300.0, -100.0}});
	std::vector<float> densities(at.size());
	const PaintedMask mask = painted();
	const PaintedMask empty;
	const ImageMask picture = image();
	ClumpNoise clumps;
	clumps.set({.size = 20.0}, 1);
	CurveTable curve;
	require(curve.set(-300.0, -100.0, std::vector<float>(256, 0.5f)));
	Contest contest(at.size());
	for (int round = 0; round < effort.rounds; ++round) {
		contest.measure(0, "painted mask", effort.seconds, [&] { require(mask.sample(at, densities)); });
		contest.measure(1, "painted mask without paint", effort.seconds, [&] { require(empty.sample(at, densities)); });
		contest.measure(2, "image mask", effort.seconds, [&] { require(picture.sample(at, densities)); });
		contest.measure(3, "clumps", effort.seconds, [&] {
			for (std::size_t i = 0; i < at.size(); ++i) {
				densities[i] = static_cast<float>(clumps.at(at[i]));
			}
		});
		contest.measure(4, "curve", effort.seconds, [&] {
			for (std::size_t i = 0; i < at.size(); ++i) {
				densities[i] = static_cast<float>(curve.at(at[i].y));
			}
		});
	}
	contest.print();
}

} // namespace
} // namespace thicket::bench

int main(int argument_count, char **arguments) {
	thicket::bench::run(thicket::bench::effort_of(argument_count, arguments));
}
