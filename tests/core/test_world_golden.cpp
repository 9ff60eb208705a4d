#include "core/base/instance_id.hpp"
#include "core/placement/placement.hpp"
#include "core/placement/tile_instances.hpp"
#include "core/rules/instance_random.hpp"
#include "core/rules/rules.hpp"
#include "core/terrain/heightfield.hpp"
#include "placement_fixture.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <vector>

using namespace thicket;

TEST_CASE("golden: ground, rules and transforms are bit-identical with every compiler and on every machine") {
	constexpr int posts = 33;
	std::vector<std::uint16_t> heights;
	for (int i = 0; i < posts * posts; ++i) {
		heights.push_back(static_cast<std::uint16_t>(i * 7919 % 9001 + i * 31));
	}
	Heightfield field;
	REQUIRE(field.set({{posts, posts}, {{-1000.3, 2000.7}, {-200.1, 2950.9}}, 236.0, 1076.0}, heights).ok());
	PreparedRules rules;
	Rules settings;
	settings.max_slope_degrees = 40.0;
	settings.slope_falloff_degrees = 25.0;
	settings.min_height = 250.0;
	settings.height_falloff = 100.0;
	REQUIRE(rules.set(settings, 20070901).ok());
	Placement placement;
	placement.min_scale = 0.7;
	placement.max_scale = 1.3;
	placement.align_to_normal = 0.35;

	std::vector<float> buffer;
	for (int row = 0; row < 100; ++row) {
		for (int column = 0; column < 100; ++column) {
			const glm::dvec2 position(-1001.0 + column * 8.1, 2000.0 + row * 9.6);
			const Ground ground = field.at(position);
			const std::uint64_t id = pack({7, {column - 50, row * 1000}});
			const std::uint32_t rank = instance_random(20070901, id, Draw::mesh)[0];
			if (is_placed(rank, rules.ground_density(ground, {}))) {
				const glm::vec3 local(
						static_cast<float>(position.x + 600.0), ground.height, static_cast<float>(position.y - 2475.0));
				std::array<float, transform_floats> transform{};
				test::write_transform(placement, 20070901, id, ground.normal, local, transform);
				buffer.insert(buffer.end(), transform.begin(), transform.end());
			}
		}
	}
	CHECK(buffer.size() / transform_floats == 955);
	CHECK(digest(buffer) == 9226695932134678077u);
}
