#include "core/heightmap/height_summary.hpp"

#include "core/terrain/heightfield.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

using namespace thicket;

namespace {

constexpr float hole = std::numeric_limits<float>::quiet_NaN();

HeightSummary summary_of(const Heightfield &field) {
	HeightSummary summary{};
	REQUIRE(summarize(field, summary).ok());
	CHECK(summary.thumbnail.size() ==
			static_cast<std::size_t>(summary.thumbnail_size.x) * static_cast<std::size_t>(summary.thumbnail_size.y) *
					2);
	return summary;
}

} // namespace

TEST_CASE("height summary: integer samples") {
	Heightfield field;
	const std::vector<std::uint16_t> posts{0, 65535, 13107, 26214, 39321, 52428};
	REQUIRE(field.set({{3, 2}, {{0.0, 0.0}, {2.0, 1.0}}, 100.0, 200.0}, posts).ok());
	const HeightSummary summary = summary_of(field);
	CHECK(summary.lowest == 100.0);
	CHECK(summary.highest == doctest::Approx(200.0));
	CHECK(summary.thumbnail_size == glm::ivec2(3, 2));
	CHECK(summary.thumbnail == std::vector<std::uint8_t>{0, 255, 255, 255, 51, 255, 102, 255, 153, 255, 204, 255});
	CHECK(field.post_height({2, 0}) == doctest::Approx(120.0));
}

TEST_CASE("height summary: float samples with holes") {
	const std::vector<float> posts{0.25F, hole, 0.75F, 1.0F};
	Heightfield field;
	REQUIRE(field.set_meters({{2, 2}, {{0.0, 0.0}, {1.0, 1.0}}, 0.0, 0.0}, posts).ok());
	CHECK(summary_of(field).lowest == 0.25);
	CHECK(summary_of(field).highest == 1.0);
	CHECK(summary_of(field).thumbnail == std::vector<std::uint8_t>{0, 255, 0, 0, 170, 255, 255, 255});
	HeightPosts units = field.posts();
	units.meaning = FloatPosts::units;
	REQUIRE(field.set_posts({{2, 2}, {{0.0, 0.0}, {1.0, 1.0}}, -10.0, 10.0}, units).ok());
	CHECK(summary_of(field).lowest == -5.0);
	CHECK(summary_of(field).highest == 10.0);
	CHECK(std::isnan(field.post_height({1, 0})));
}

TEST_CASE("height summary: flat ground and holes everywhere") {
	Heightfield field;
	const HeightfieldFrame frame{{2, 2}, {{0.0, 0.0}, {1.0, 1.0}}, 0.0, 0.0};
	REQUIRE(field.set_meters(frame, std::vector<float>(4, 7.0F)).ok());
	CHECK(summary_of(field).lowest == 7.0);
	CHECK(summary_of(field).thumbnail == std::vector<std::uint8_t>{0, 255, 0, 255, 0, 255, 0, 255});
	REQUIRE(field.set_meters(frame, std::vector<float>(4, hole)).ok());
	CHECK(std::isnan(summary_of(field).lowest));
	CHECK(std::isnan(summary_of(field).highest));
	CHECK(summary_of(field).thumbnail == std::vector<std::uint8_t>(8));
}

TEST_CASE("height summary: the thumbnail of a large map is small") {
	Heightfield field;
	std::vector<float> posts;
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 1000; ++column) {
			posts.push_back(static_cast<float>(column));
		}
	}
	REQUIRE(field.set_meters({{1000, 3}, {{0.0, 0.0}, {999.0, 2.0}}, 0.0, 0.0}, posts).ok());
	const HeightSummary summary = summary_of(field);
	CHECK(summary.thumbnail_size == glm::ivec2(max_thumbnail_side, 1));
	for (std::size_t pixel = 1; pixel < max_thumbnail_side; ++pixel) {
		CHECK(summary.thumbnail[2 * pixel] > summary.thumbnail[2 * pixel - 2]);
	}
}
