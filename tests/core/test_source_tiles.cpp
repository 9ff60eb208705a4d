// Tests the colors and variations of whole tiles that depend on height, slope, noise, rank, or the
// distance to another layer.

#include "core/base/trigonometry.hpp"
#include "core/base/word_hash.hpp"
#include "core/placement/layer_edits.hpp"
#include "repeated_builds.hpp"
#include "sources_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <span>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

struct Seen {
	std::size_t color = 0;
	float variation = 0.0f;
	std::uint32_t rank = 0;

	friend bool operator==(const Seen &, const Seen &) = default;
};

using Appearances = std::map<std::uint64_t, Seen>;

Appearances appearance_of(const TileInstances &tile) {
	Appearances result;
	for (const MeshInstances &mesh : tile.meshes) {
		REQUIRE(mesh.stride == 20);
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const float *floats = mesh.buffer.data() + i * mesh.stride;
			result[mesh.ids[i]] = {static_cast<std::size_t>(floats[12]), floats[16], mesh.ranks[i]};
		}
	}
	return result;
}

/// Returns the positions of a set's points, keyed by ID, in double precision.
std::map<std::uint64_t, glm::dvec2> points_of(const PointSet &set, const Rect &rect) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(set, rect, points).ok());
	std::map<std::uint64_t, glm::dvec2> result;
	for (const SamplePoint &point : points) {
		result.emplace(point.id, point.position);
	}
	return result;
}

/// Returns the positions of a layer's instances.
std::vector<glm::dvec2> instance_positions(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	const auto points = points_of(layer.set, rect);
	std::vector<glm::dvec2> result;
	for (const auto &[id, transform] : transforms_of(built(layer, terrain, rect))) {
		result.push_back(points.at(id));
	}
	return result;
}

/// A reference implementation of the sources.
class Finder {
public:
	explicit Finder(const Terrain &terrain, const Rect &rect) :
			terrain_(terrain), oaks_(instance_positions(*oaks(), terrain, grown(rect, 2.0 * farthest))) {}

	double at(SourceKind kind, glm::dvec2 position, std::uint32_t rank) const {
		const Ground ground = terrain_.at(position);
		const float noise = Waves::at(position);
		switch (kind) {
			case SourceKind::height: return double{ground.height};
			case SourceKind::slope: return slope_degrees(ground.normal);
			case SourceKind::noise: return std::isnan(noise) ? 0.0 : std::clamp(double{noise}, 0.0, 1.0);
			case SourceKind::rank: return rank * 0x1p-32;
			case SourceKind::distance: return distance(position);
			default: return 0.0;
		}
	}

private:
	double distance(glm::dvec2 position) const {
		double nearest = 1e9;
		for (const glm::dvec2 oak : oaks_) {
			nearest = std::min(nearest, glm::distance(position, oak));
		}
		return nearest;
	}

	const Terrain &terrain_;
	std::vector<glm::dvec2> oaks_;
};

} // namespace

TEST_CASE("sources: colors and variations match each source's value at the instance") {
	const Heightfield terrain = hills();
	const Finder finder(terrain, tile_of_hills);
	const auto points = points_of(rich_layer().set, tile_of_hills);
	for (std::size_t i = 0; i < kinds.size(); ++i) {
		const InstanceSource color = source_of(kinds[i]);
		const InstanceSource variation = source_of(kinds[(i + 2) % kinds.size()]);
		CAPTURE(i);
		const Appearances appearances =
				appearance_of(built(layer_with_sources(color, variation), terrain, tile_of_hills));
		CHECK(appearances.size() > 500);
		std::size_t first = 0;
		std::size_t mixed_count = 0;
		for (const auto &[id, seen] : appearances) {
			const double expected = expected_fraction(color, finder.at(color.kind, points.at(id), seen.rank));
			const double color_position = std::min(expected * colors, colors - 1.0);
			CHECK(std::abs(static_cast<double>(seen.color) + 0.5 - color_position) <= 0.5 + 1e-3);
			first += seen.color == 0 ? 1 : 0;
			mixed_count += seen.color > 0 && seen.color < colors - 1 ? 1 : 0;
			const double other = expected_fraction(variation, finder.at(variation.kind, points.at(id), seen.rank));
			CHECK(std::abs(double{seen.variation} - other) < 1e-3);
		}
		CHECK(mixed_count > 100); // Many values lie inside the range, and some are at its lower end.
		CHECK((first > 10 || kinds[i] == SourceKind::rank));
	}
}

TEST_CASE("sources: colors and variations affect no other data of a tile") {
	const Heightfield terrain = hills();
	const TileInstances before = built(layer_with_sources({}, {}), terrain, tile_of_hills);
	for (const SourceKind kind : kinds) {
		const TileInstances after = built(layer_with_sources(source_of(kind), source_of(kind)), terrain, tile_of_hills);
		CHECK(digest(after) != digest(before));
		for (std::size_t mesh = 0; mesh < before.meshes.size(); ++mesh) {
			CHECK(after.meshes[mesh].ids == before.meshes[mesh].ids);
			for (std::size_t i = 0; i < before.meshes[mesh].size(); ++i) {
				const float *old_floats = before.meshes[mesh].buffer.data() + i * 20;
				const float *new_floats = after.meshes[mesh].buffer.data() + i * 20;
				CHECK(std::equal(old_floats, old_floats + 12, new_floats));
				CHECK(std::equal(
						old_floats + 17, old_floats + 20, new_floats + 17)); // The wind phase, the rank and the scale.
			}
		}
	}
}

TEST_CASE("sources: purely random values are bit-identical to a layer without sources") {
	const Heightfield terrain = hills();
	const std::uint64_t plain = digest(built(layer_with_sources({}, {}), terrain, tile_of_hills));
	for (const SourceKind kind : kinds) {
		InstanceSource source = source_of(kind);
		source.randomness = 1.0;
		CHECK(digest(built(layer_with_sources(source, source), terrain, tile_of_hills)) == plain);
	}
	for (const SourceKind kind : {SourceKind::noise, SourceKind::distance}) {
		InstanceSource source{.kind = kind}; // The source has no noise and no layer.
		CHECK(digest(built(layer_with_sources(source, source), terrain, tile_of_hills)) == plain);
	}
}

TEST_CASE("sources: randomness spreads values evenly over its part of the gradient") {
	const Heightfield terrain = hills();
	InstanceSource source = source_of(SourceKind::height);
	const Appearances sharp = appearance_of(built(layer_with_sources(source, {}), terrain, tile_of_hills));
	source.randomness = 0.2;
	const Appearances spread = appearance_of(built(layer_with_sources(source, {}), terrain, tile_of_hills));
	double sum = 0.0;
	for (const auto &[id, seen] : spread) {
		const double color_distance =
				static_cast<double>(seen.color) / colors - 0.8 * static_cast<double>(sharp.at(id).color) / colors;
		CHECK(color_distance > -2e-3);
		CHECK(color_distance < 0.2 + 2e-3);
		sum += color_distance;
	}
	CHECK(sum / static_cast<double>(spread.size()) == doctest::Approx(0.1).epsilon(0.1));
}

TEST_CASE("sources: tiles of any size and order, and threads, produce the same values") {
	const Heightfield terrain = hills();
	for (std::size_t i = 0; i < kinds.size(); ++i) {
		CAPTURE(i);
		InstanceSource color = source_of(kinds[i]);
		color.randomness = 0.3;
		const LayerSettings layer = layer_with_sources(color, source_of(kinds[(i + 1) % kinds.size()]));
		const TileInstances tile = built(layer, terrain, tile_of_hills);
		const Appearances whole_tile = appearance_of(tile);
		for (const glm::dvec2 size : {glm::dvec2(128.0, 11.0), glm::dvec2(23.5, 40.0)}) {
			Appearances joined_parts;
			for (double y = tile_of_hills.max.y; y > tile_of_hills.min.y; y -= size.y) {
				for (double x = tile_of_hills.min.x; x < tile_of_hills.max.x; x += size.x) {
					const Rect slice{{x, std::max(y - size.y, tile_of_hills.min.y)},
							{std::min(x + size.x, tile_of_hills.max.x), y}};
					joined_parts.merge(appearance_of(built(layer, terrain, slice)));
				}
			}
			CHECK(joined_parts == whole_tile);
		}
		check_on_threads(layer, terrain, digest(tile));
	}
}

TEST_CASE("sources: the other layer yields to its own neighbors first, which changes the nearest instance") {
	const Heightfield terrain = hills();
	auto stones = std::make_shared<LayerSettings>();
	stones->set = {.seed = 5, .radius = 6.0, .levels = 1, .layer = 9};
	auto kept_away = std::make_shared<LayerSettings>(*oaks());
	kept_away->neighbors = {{stones, 4.0, nullptr}};
	InstanceSource source = source_of(SourceKind::distance);
	const Appearances unlimited = appearance_of(built(layer_with_sources(source, {}), terrain, tile_of_hills));
	source.layer = kept_away;
	const LayerSettings layer = layer_with_sources(source, {});
	CHECK(reach(layer) == farthest + 4.0);
	const Appearances appearances = appearance_of(built(layer, terrain, tile_of_hills));
	CHECK(appearances != unlimited);
	const std::vector<glm::dvec2> standing_positions =
			instance_positions(*kept_away, terrain, grown(tile_of_hills, 2.0 * farthest));
	CHECK(standing_positions.size() <
			instance_positions(*oaks(), terrain, grown(tile_of_hills, 2.0 * farthest)).size());
	const auto points = points_of(layer.set, tile_of_hills);
	Appearances joined_parts;
	for (double y = tile_of_hills.min.y; y < tile_of_hills.max.y; y += 16.0) {
		const Rect slice{{tile_of_hills.min.x, y}, {tile_of_hills.max.x, y + 16.0}};
		joined_parts.merge(appearance_of(built(layer, terrain, slice)));
	}
	CHECK(joined_parts == appearances);
	for (const auto &[id, seen] : appearances) {
		double nearest = farthest;
		for (const glm::dvec2 other : standing_positions) {
			nearest = std::min(nearest, glm::distance(points.at(id), other));
		}
		const double color_position = std::min(expected_fraction(source, nearest) * colors, colors - 1.0);
		CHECK(std::abs(static_cast<double>(seen.color) + 0.5 - color_position) <= 0.5 + 1e-3);
	}
}

TEST_CASE("sources: values are bit-identical on every machine") {
	const Heightfield terrain = hills();
	WordHash hash;
	for (std::size_t i = 0; i < kinds.size(); ++i) {
		InstanceSource color = source_of(kinds[i]);
		color.randomness = 0.3;
		const LayerSettings layer = layer_with_sources(color, source_of(kinds[(i + 1) % kinds.size()]));
		hash.add(digest(built(layer, terrain, tile_of_hills)));
	}
	CHECK(hash.value() == 7585625650852969798u);
}

TEST_CASE("sources: repeated calls allocate nothing") {
	const Heightfield terrain = hills();
	const LayerSettings layer = layer_with_sources(source_of(SourceKind::noise), source_of(SourceKind::distance));
	check_repeated_builds_allocate_nothing(layer, terrain);
}

TEST_CASE("sources: canceling ends the evaluation of sources") {
	class Cancelling final : public DensityField {
	public:
		explicit Cancelling(std::atomic<bool> &cancel) : cancel_(cancel) {}

		Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override {
			CHECK(positions.size() == r_density.size());
			CHECK_FALSE(cancel_.exchange(true)); // After cancellation, the field is not sampled again.
			return {};
		}

	private:
		std::atomic<bool> &cancel_;
	};
	std::atomic<bool> cancel = false;
	InstanceSource source = source_of(SourceKind::noise);
	source.noise = std::make_shared<const Cancelling>(cancel);
	LayerSettings layer = layer_with_sources(source, {});
	layer.set.radius = 0.8;
	const Heightfield terrain = hills();
	TileInstances tile;
	CHECK(TileBuilder().build(layer, terrain, tile_of_hills, tile, &cancel).code == ErrorCode::cancelled);
}

TEST_CASE("sources: building in two steps produces the same tile as in one") {
	const Heightfield terrain = hills();
	const LayerSettings layer = layer_with_sources(source_of(SourceKind::distance), source_of(SourceKind::slope));
	TileBuilder builder;
	REQUIRE(builder.find_points(layer, tile_of_hills).ok());
	std::vector<Ground> ground(builder.positions().size());
	REQUIRE(terrain.sample(builder.positions(), ground).ok());
	TileInstances tile;
	REQUIRE(builder.place(ground, tile).ok());
	CHECK(digest(tile) == digest(built(layer, terrain, tile_of_hills)));
}
