// Tests that transforms in batches are bit-identical to single transforms, on every instruction
// set.

#include "core/placement/transform_batch.hpp"
#include "placement_fixture.hpp"
#include "tile_fixture.hpp"
#include "tests/bench/common/simd_targets.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

std::vector<Placement> placements() {
	std::vector<Placement> result(1);
	result.push_back({.min_yaw_degrees = -360.0,
			.max_yaw_degrees = 360.0,
			.min_scale = 0.3,
			.max_scale = 7.0,
			.align_to_normal = 1.0,
			.offset_along_normal = 2.0});
	result.push_back({.min_yaw_degrees = 90.0, .max_yaw_degrees = 90.0, .align_to_normal = 0.0});
	result.push_back({.min_yaw_degrees = -180.0,
			.max_yaw_degrees = -180.0,
			.align_to_normal = 0.4,
			.min_tilt_degrees = 90.0,
			.max_tilt_degrees = 90.0});
	result.push_back({.min_scale = 1e-4, .max_scale = 1e4, .min_tilt_degrees = 0.0, .max_tilt_degrees = 45.0});
	result.push_back({.max_scale = 2.0, .align_to_normal = 0.7, .min_tilt_degrees = 10.0, .max_tilt_degrees = 20.0});
	auto curve = std::make_shared<CurveTable>();
	REQUIRE(curve->set(0.0, 1.0, std::vector<float>{0.0f, 0.2f, 1.0f}).ok());
	result.push_back({.min_scale = 0.5, .max_scale = 2.0, .align_to_normal = 0.7, .scale_curve = curve});
	return result;
}

} // namespace

TEST_CASE("transform batch: batches are bit-identical to single transforms, on every instruction set") {
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		for (const Placement &placement : placements()) {
			std::mt19937_64 random(7);
			std::mt19937 normals(8);
			TransformBatch batch;
			for (int round = 0; round < 60; ++round) {
				std::vector<std::uint64_t> ids;
				std::vector<glm::vec3> normal_list;
				std::vector<glm::vec3> positions;
				std::vector<std::optional<Rotation>> headings;
				batch.count = 0;
				const std::size_t count = 1 + random() % TransformBatch::capacity;
				while (ids.size() < count) {
					ids.push_back(random());
					const glm::vec3 normal = random() % 8 == 0 ? glm::vec3(-0.0f, 1.0f, 0.0f) : random_normal(normals);
					normal_list.push_back(round % 3 == 0 && random() % 4 == 0 ? -normal : normal);
					positions.emplace_back(static_cast<float>(random() % 1000), -0.0f, static_cast<float>(count));
					const double turn = static_cast<double>(random() % 1000) / 159.0;
					headings.push_back(
							round % 5 == 1 ? std::optional(Rotation{std::cos(turn), std::sin(turn)}) : std::nullopt);
					batch.set_heading(headings.back());
					batch.add(ids.back(), normal_list.back(), positions.back());
				}
				std::vector<double> scale_numbers;
				while (round % 2 == 0 && scale_numbers.size() < count) {
					scale_numbers.push_back(static_cast<double>(random() % 1001) / 1000.0);
				}
				batch.make(placement, seed + static_cast<std::uint64_t>(round), {}, scale_numbers);
				for (std::size_t i = 0; i < count; ++i) {
					std::array<float, transform_floats> expected{};
					expected[3] = positions[i].x;
					expected[7] = positions[i].y;
					expected[11] = positions[i].z;
					std::array<float, transform_floats> actual{};
					const float scale = write_basis(placement, seed + static_cast<std::uint64_t>(round), ids[i],
							normal_list[i], expected, {},
							scale_numbers.empty() ? std::nullopt : std::optional(scale_numbers[i]), headings[i]);
					batch.write(i, actual);
					REQUIRE(std::memcmp(expected.data(), actual.data(), sizeof actual) == 0);
					REQUIRE(batch.scale[i] == scale);
				}
			}
		}
	}
}

TEST_CASE("transform batch: vectors compute the transforms, and write beyond the last transform") {
	TransformBatch batch;
	batch.scale.fill(-1.0f);
	batch.add(5, up, {});
	batch.make({}, seed);
	CHECK(batch.scale[0] == 1.0f);
	CHECK(batch.scale[1] == 1.0f); // Scalar code would leave it unchanged.
}

TEST_CASE("transform batch: tiles are placed, and restored from compact tiles, in vectors") {
	TileBuilder builder;
	TileInstances tile;
	LayerSettings layer = rich_layer();
	const auto places_by_vectors = [&] {
		REQUIRE(builder.find_points(layer, {{0.0, 0.0}, {30.0, 30.0}}).ok());
		const std::vector<Ground> ground(builder.positions().size(), {20.0f});
		return bench::runs_vectors([&] { REQUIRE(builder.place(ground, tile).ok()); });
	};
	CHECK(places_by_vectors());
	REQUIRE(tile.meshes[0].size() > 10);
	const std::shared_ptr<const CompactTile> compact = compact_tile(layer, tile);
	const CompactMesh &mesh = compact->meshes[0];
	std::vector<float> floats(mesh.size() * mesh.stride());
	CHECK(bench::runs_vectors([&] { mesh.read_all(floats); }));
	CHECK(bench::runs_vectors(
			[&] { mesh.read(std::vector<std::uint32_t>{3, 1}, std::span(floats).first(2 * mesh.stride())); }));
	CHECK_FALSE(bench::runs_vectors([&] { mesh.read(std::vector<std::uint32_t>{}, {}); }));
	layer.placement.scale_curve = placements().back().scale_curve;
	CHECK(places_by_vectors());
}
