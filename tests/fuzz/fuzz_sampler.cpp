// Samples random point sets and rectangles. The sampler must either reject a call or return points
// with all guaranteed properties.

#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/base/instance_id.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <cmath>
#include <map>
#include <vector>

namespace {

using namespace thicket;
using fuzz::Bytes;
using fuzz::require;

PointSet read_set(Bytes &r_bytes) {
	PointSet set;
	set.seed = r_bytes.raw<std::uint64_t>();
	set.radius = r_bytes.number(0.05, 20.0);
	set.levels = r_bytes.chance(16) ? r_bytes.raw<std::uint32_t>() : 1 + r_bytes.below(max_levels);
	set.layer = r_bytes.raw<std::uint16_t>();
	return set;
}

Rect read_rect(Bytes &r_bytes, double radius) {
	const double scale = std::isfinite(radius) ? radius : 1.0;
	Rect rect;
	const double far_away = r_bytes.chance(3) ? 5.9e6 : 50.0;
	rect.min.x = scale * r_bytes.number(-far_away, far_away);
	rect.min.y = scale * r_bytes.number(-far_away, far_away);
	rect.max.x = rect.min.x + scale * r_bytes.number(-1.0, 24.0);
	rect.max.y = rect.min.y + scale * r_bytes.number(-1.0, 24.0);
	if (r_bytes.chance(8)) {
		rect.max = {r_bytes.number(-50.0, 50.0), r_bytes.number(-50.0, 50.0)};
	}
	return rect;
}

void check_points(const PointSet &set, const Rect &rect, const std::vector<SamplePoint> &points) {
	std::map<std::pair<int, int>, glm::i64vec2> cells;
	for (const SamplePoint &point : points) {
		require(rect.contains(point.position), "a point lies in its rectangle");
		require(point.level < set.levels, "a point has one of the levels of its set");
		require((point.rank < level_rank_end(set.levels, point.level)), "a rank belongs to its level");
		const InstanceId id = unpack(point.id);
		require(id.layer == set.layer, "an ID contains the layer");
		const glm::i64vec2 lattice = lattice_position(set, point);
		require(lattice.x >> lattice_bits == id.cell.x && lattice.y >> lattice_bits == id.cell.y,
				"an ID contains the cell");
		for (int y = -2; y <= 2; ++y) {
			for (int x = -2; x <= 2; ++x) {
				const auto neighbor = cells.find({id.cell.x + x, id.cell.y + y});
				if (neighbor != cells.end()) {
					const glm::i64vec2 offset = neighbor->second - lattice;
					require(offset.x * offset.x + offset.y * offset.y >= std::int64_t{2} << (2 * lattice_bits),
							"points keep the minimum distance");
				}
			}
		}
		require(cells.emplace(std::pair(id.cell.x, id.cell.y), lattice).second, "a cell contains at most one point");
	}
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	static TileSampler sampler;
	Bytes bytes(data, size);
	const PointSet set = read_set(bytes);
	const Rect rect = read_rect(bytes, set.radius);

	// Large requests are valid, but slow, so they are canceled immediately.
	const std::atomic<bool> cancel{true};
	const double expected = rect.size().x * rect.size().y * point_density(set);
	const bool small = expected < 3000.0 && std::max(rect.size().x, rect.size().y) < 1000.0 * set.radius;
	std::vector<SamplePoint> points(1, SamplePoint{glm::dvec2(0.5), 77, 1, 0});
	const std::vector<SamplePoint> before = points;
	const Status status = sampler.sample(set, rect, points, {.cancel = small ? nullptr : &cancel, .report = {}});
	if (status.ok()) {
		require(!rect.empty() || points.empty(), "an empty rectangle has no points");
		check_points(set, rect, points);
		std::vector<SamplePoint> repeated;
		require(TileSampler().sample(set, rect, repeated).ok() && repeated == points,
				"the same call returns the same points");
	} else if (status.code != ErrorCode::cancelled) {
		require(points == before, "a rejected call has no effect");
		require(describe(status).find(status.property) == 0, "an error names the property");
	}
	return 0;
}
