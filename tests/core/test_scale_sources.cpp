// Tests scales that depend on height, slope, noise, rank, or the distance to another layer.

#include "core/base/trigonometry.hpp"
#include "core/base/word_hash.hpp"
#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_graph.hpp"
#include "refusal.hpp"
#include "repeated_builds.hpp"
#include "sources_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

LayerSettings layer_with_scale(const InstanceSource &source) {
	LayerSettings layer = rich_layer();
	layer.placement.min_scale = 0.25;
	layer.placement.max_scale = 2.0;
	layer.instance_data.scale = {source};
	return layer;
}

struct Placed {
	glm::dvec3 position;
	std::array<glm::vec3, 3> axes;
	std::uint32_t rank = 0;
	std::size_t mesh = 0;

	float scale() const { return glm::length(axes[1]); }
};

std::map<std::uint64_t, Placed> placed_in(const TileInstances &tile) {
	std::map<std::uint64_t, Placed> result;
	for (std::size_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
		const MeshInstances &instances = tile.meshes[mesh];
		for (std::size_t i = 0; i < instances.size(); ++i) {
			const float *floats = instances.buffer.data() + i * instances.stride;
			Placed placed{world_position(tile, instances, i), {}, instances.ranks[i], mesh};
			for (std::size_t axis = 0; axis < 3; ++axis) {
				placed.axes[axis] = {floats[axis], floats[4 + axis], floats[8 + axis]};
			}
			result[instances.ids[i]] = placed;
		}
	}
	return result;
}

/// Returns the value of a source at an instance, from its position. A reference implementation.
double value_at(
		SourceKind kind, const Placed &instance, const Terrain &terrain, std::span<const glm::dvec2> neighbors) {
	const glm::dvec2 position{instance.position.x, instance.position.z};
	const Ground ground = terrain.at(position);
	switch (kind) {
		case SourceKind::height: return double{ground.height};
		case SourceKind::slope: return slope_degrees(ground.normal);
		case SourceKind::noise: return std::clamp(double{Waves::at(position)}, 0.0, 1.0);
		case SourceKind::rank: return instance.rank * 0x1p-32;
		default: break;
	}
	double nearest = 1e9;
	for (const glm::dvec2 other : neighbors) {
		nearest = std::min(nearest, glm::distance(position, other));
	}
	return nearest;
}

/// A curve that falls from 1 to 0.
std::shared_ptr<const CurveTable> falling() {
	const auto curve = std::make_shared<CurveTable>();
	REQUIRE(curve->set(0.0, 1.0, std::array{1.0f, 0.0f}).ok());
	return curve;
}

} // namespace

TEST_CASE("scale sources: the scale matches the source's value at the instance") {
	const Heightfield terrain = hills();
	std::vector<glm::dvec2> neighbors;
	for (const auto &[id, oak] : placed_in(built(*oaks(), terrain, grown(tile_of_hills, 2.0 * farthest)))) {
		neighbors.emplace_back(oak.position.x, oak.position.z);
	}
	for (const SourceKind kind : kinds) {
		CAPTURE(static_cast<int>(kind));
		const InstanceSource source = source_of(kind);
		std::size_t middle_count = 0;
		std::size_t wrong_count = 0;
		for (const auto &[id, placed] : placed_in(built(layer_with_scale(source), terrain, tile_of_hills))) {
			const double value = value_at(kind, placed, terrain, neighbors);
			if (std::isnan(value)) {
				continue;
			}
			const double expected = 0.25 + 1.75 * expected_fraction(source, value);
			// Noise jumps where its period ends, and positions are rounded to floats.
			wrong_count += std::abs(double{placed.scale()} - expected) < 1e-3 ? 0 : 1;
			middle_count += expected > 0.26 && expected < 1.99 ? 1 : 0;
		}
		CHECK(wrong_count <= 1);
		CHECK(middle_count > 100);
	}
}

TEST_CASE("scale sources: a source affects no other part of an instance") {
	const Heightfield terrain = hills();
	const auto before = placed_in(built(layer_with_scale({}), terrain, tile_of_hills));
	for (const SourceKind kind : kinds) {
		const auto after = placed_in(built(layer_with_scale(source_of(kind)), terrain, tile_of_hills));
		REQUIRE(after.size() == before.size());
		double differences = 0.0;
		for (const auto &[id, placed] : after) {
			const Placed &previous = before.at(id);
			CHECK(placed.position == previous.position);
			CHECK(placed.rank == previous.rank);
			CHECK(placed.mesh == previous.mesh);
			for (std::size_t axis = 0; axis < 3; ++axis) {
				CHECK(glm::distance(placed.axes[axis] / placed.scale(), previous.axes[axis] / previous.scale()) <
						1e-5f);
			}
			differences += std::abs(placed.scale() - previous.scale());
		}
		CHECK(differences > 100.0);
	}
}

TEST_CASE("scale sources: randomness, the source's curve and the layer's curve apply in this order") {
	const Heightfield terrain = hills();
	InstanceSource source = source_of(SourceKind::height);
	const auto sharp = placed_in(built(layer_with_scale(source), terrain, tile_of_hills));
	const auto random = placed_in(built(layer_with_scale({}), terrain, tile_of_hills));
	source.randomness = 0.25;
	const auto mixed = placed_in(built(layer_with_scale(source), terrain, tile_of_hills));
	source.curve = falling();
	const auto falls = placed_in(built(layer_with_scale(source), terrain, tile_of_hills));
	LayerSettings layer = layer_with_scale(source);
	layer.placement.scale_curve = falling();
	const auto rises = placed_in(built(layer, terrain, tile_of_hills));
	const auto only_curve = placed_in(built(layer_with_scale({.curve = falling()}), terrain, tile_of_hills));
	for (const auto &[id, placed] : mixed) {
		const float expected = 0.75f * sharp.at(id).scale() + 0.25f * random.at(id).scale();
		CHECK(placed.scale() == doctest::Approx(expected).epsilon(1e-4));
		CHECK(falls.at(id).scale() == doctest::Approx(2.25f - expected).epsilon(1e-4));
		CHECK(rises.at(id).scale() == doctest::Approx(expected).epsilon(1e-4));
		CHECK(only_curve.at(id).scale() == doctest::Approx(2.25f - random.at(id).scale()).epsilon(1e-4));
	}
}

TEST_CASE("scale sources: tiles of any size, threads and compact tiles contain the same bits") {
	const Heightfield terrain = hills();
	for (const SourceKind kind : kinds) {
		CAPTURE(static_cast<int>(kind));
		InstanceSource source = source_of(kind);
		source.randomness = 0.3;
		const LayerSettings layer = layer_with_scale(source);
		const TileInstances tile = built(layer, terrain, tile_of_hills);
		std::map<std::uint64_t, float> joined_parts;
		for (double y = tile_of_hills.min.y; y < tile_of_hills.max.y; y += 11.0) {
			const Rect slice{{tile_of_hills.min.x, y}, {tile_of_hills.max.x, std::min(y + 11.0, tile_of_hills.max.y)}};
			for (const auto &[id, placed] : placed_in(built(layer, terrain, slice))) {
				joined_parts.emplace(id, placed.axes[1].y);
			}
		}
		const auto whole_tile = placed_in(tile);
		REQUIRE(joined_parts.size() == whole_tile.size());
		for (const auto &[id, placed] : whole_tile) {
			CHECK(joined_parts.at(id) == placed.axes[1].y);
		}
		check_on_threads(layer, terrain, digest(tile));
		const std::shared_ptr<const CompactTile> compact = compact_tile(layer, tile);
		CHECK(digest(expanded(*compact)) == digest(tile));
		std::vector<float> floats(compact->meshes[0].stride());
		for (std::size_t i = 0; i < compact->meshes[0].size(); i += 7) {
			compact->meshes[0].read(i, floats);
			CHECK(std::memcmp(floats.data(), tile.meshes[0].buffer.data() + i * floats.size(),
						  floats.size() * sizeof(float)) == 0);
		}
	}
}

TEST_CASE("scale sources: scales are bit-identical on every machine") {
	const Heightfield terrain = hills();
	WordHash hash;
	for (const SourceKind kind : kinds) {
		InstanceSource source = source_of(kind);
		source.randomness = 0.3;
		hash.add(digest(built(layer_with_scale(source), terrain, tile_of_hills)));
	}
	CHECK(hash.value() == 17185146811803504320u);
}

TEST_CASE("scale sources: repeated calls allocate nothing") {
	const Heightfield terrain = hills();
	const LayerSettings layer = layer_with_scale(source_of(SourceKind::distance));
	check_repeated_builds_allocate_nothing(layer, terrain);
}

TEST_CASE("scale sources: errors name the property") {
	LayerSettings layer = layer_with_scale(source_of(SourceKind::height));
	layer.instance_data.scale.min = 80.0;
	check_refused(validate(layer), ErrorCode::inverted, "scale_value.max_value", 70.0);
	layer.instance_data.scale = {{.kind = SourceKind::slope, .randomness = -1.0}};
	check_refused(validate(layer), ErrorCode::out_of_range, "scale_value.randomness", -1.0);
}

TEST_CASE("scale sources: an edit of the other layer affects scales within the source's distance") {
	LayerSettings before = layer_with_scale(source_of(SourceKind::distance));
	LayerSettings after = before;
	auto other = std::make_shared<LayerSettings>(*oaks());
	after.instance_data.scale.layer = other;
	CHECK(EditSearch().find(before, after).empty());
	other->rules.mask = painted_at(glm::dvec2(10.0, 0.0));
	auto blank = std::make_shared<LayerSettings>(*oaks());
	blank->rules.mask = painted_at({});
	before.instance_data.scale.layer = blank;
	const EditedArea area = EditSearch().find(before, after);
	CHECK_FALSE(area.everywhere);
	CHECK(area.touches({{11.0 + farthest - 0.5, 0.0}, {40.0, 1.0}}));
	CHECK_FALSE(area.touches({{12.0 + farthest, 0.0}, {40.0, 1.0}}));
	CHECK(reach(before) == farthest);
}
