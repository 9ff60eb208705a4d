#include "core/terrain/heightfield.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <type_traits>
#include <vector>

using namespace thicket;

namespace {

HeightfieldFrame frame_of(glm::ivec2 posts) {
	return {posts, {{-100.0, 50.0}, {-100.0 + posts.x - 1, 50.0 + 2.0 * (posts.y - 1)}}, 10.0, 300.0};
}

/// Returns random 16-bit height samples ("posts").
std::vector<std::uint16_t> random_steps(std::size_t count, unsigned seed) {
	std::mt19937 random(seed);
	std::vector<std::uint16_t> steps(count);
	for (std::uint16_t &step : steps) {
		step = static_cast<std::uint16_t>(random());
	}
	return steps;
}

/// Returns random samples from 0 to 1. Some of them are holes (NaN).
std::vector<float> random_units(std::size_t count, unsigned seed) {
	std::mt19937 random(seed);
	std::uniform_real_distribution<float> unit(0.0F, 1.0F);
	std::vector<float> units(count);
	for (float &post : units) {
		post = random() % 50 == 0 ? std::numeric_limits<float>::quiet_NaN() : unit(random);
	}
	return units;
}

template <typename Post>
HeightPosts shared(glm::ivec2 count, const std::vector<Post> &posts, FloatPosts meaning) {
	const PostGrid<Post> grid(count, std::make_shared<const std::vector<Post>>(posts));
	if constexpr (std::is_same_v<Post, float>) {
		return {{}, grid, meaning};
	} else {
		return {grid, {}, meaning};
	}
}

/// Checks that a field of `before`, patched inside `rect` with the samples of `after`, equals a new
/// field of the patched samples.
template <typename Post>
void check_patched(glm::ivec2 count, const std::vector<Post> &before, std::vector<Post> after, const PixelRect &rect,
		FloatPosts meaning) {
	std::vector<Post> all = before;
	std::vector<Post> patch_posts;
	for (int row = rect.min.y; row < rect.max.y; ++row) {
		for (int column = rect.min.x; column < rect.max.x; ++column) {
			const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(count.x) +
					static_cast<std::size_t>(column);
			all[at] = after[at];
			patch_posts.push_back(after[at]);
		}
	}
	Heightfield expected;
	REQUIRE(expected.set_posts(frame_of(count), shared(count, all, meaning)).ok());
	Heightfield original;
	REQUIRE(original.set_posts(frame_of(count), shared(count, before, meaning)).ok());
	Heightfield patched = original;
	REQUIRE(patched.patch(rect, std::span<const Post>(patch_posts)).ok());
	Heightfield rebuilt;
	REQUIRE(rebuilt.set_posts(frame_of(count), shared(count, before, meaning)).ok());

	std::vector<Rect> areas;
	patched.add_changes(original, areas);
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(-0.02, 1.02);
	for (int i = 0; i < 4000; ++i) {
		const Rect area = frame_of(count).area;
		const glm::dvec2 at = area.min + glm::dvec2(unit(random), unit(random)) * area.size();
		const Ground patched_ground = patched.at(at);
		const Ground original_ground = original.at(at);
		const auto same = [](const Ground &a, const Ground &b) {
			return std::memcmp(&a.height, &b.height, sizeof a.height) == 0 &&
					(std::isnan(a.height) || a.normal == b.normal);
		};
		CHECK(same(patched_ground, expected.at(at)));
		CHECK(same(original_ground, rebuilt.at(at)));
		if (!same(patched_ground, original_ground)) {
			const auto contains_at = [at](const Rect &rect) {
				return at.x >= rect.min.x && at.x <= rect.max.x && at.y >= rect.min.y && at.y <= rect.max.y;
			};
			CHECK(std::ranges::any_of(areas, contains_at));
		}
	}
	CHECK((std::memcmp(all.data(), before.data(), all.size() * sizeof(Post)) != 0) == !areas.empty());
	std::vector<Rect> no_rects;
	patched.add_changes(expected, no_rects);
	expected.add_changes(patched, no_rects);
	CHECK(no_rects.empty());
}

} // namespace

TEST_CASE("post grid: a patched field equals the field of the patched samples, bit for bit") {
	for (const glm::ivec2 count :
			{glm::ivec2(2, 2), glm::ivec2(5, 131), glm::ivec2(129, 130), glm::ivec2(300, 260), glm::ivec2(257, 257)}) {
		const auto posts = static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y);
		for (const PixelRect rect : {PixelRect{{0, 0}, count}, PixelRect{{0, 0}, {1, 1}}, PixelRect{count - 1, count},
					 PixelRect{count / 2, count / 2 + 1}, PixelRect{{count.x / 3, 0}, {count.x / 3 + 1, count.y}},
					 PixelRect{{0, count.y * 2 / 5}, {count.x, count.y * 2 / 5 + 1}}}) {
			CAPTURE(count.x);
			CAPTURE(rect.min.x);
			check_patched(count, random_steps(posts, 1), random_steps(posts, 2), rect, FloatPosts::meters);
			check_patched(count, random_units(posts, 1), random_units(posts, 2), rect, FloatPosts::units);
			check_patched(count, random_units(posts, 1), random_units(posts, 2), rect, FloatPosts::meters);
		}
	}
}

TEST_CASE("post grid: patches accumulate, and each copy has its own patches") {
	const glm::ivec2 count(400, 300);
	const auto posts = static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y);
	std::vector<std::uint16_t> steps = random_steps(posts, 5);
	PostGrid<std::uint16_t> grid(count, std::make_shared<const std::vector<std::uint16_t>>(steps));
	const PostGrid<std::uint16_t> untouched = grid;
	std::mt19937 random(8);
	for (int i = 0; i < 60; ++i) {
		const glm::ivec2 from(static_cast<int>(random() % 390), static_cast<int>(random() % 290));
		const glm::ivec2 size(1 + static_cast<int>(random() % 10), 1 + static_cast<int>(random() % 10));
		std::vector<std::uint16_t> patch_posts;
		for (int row = 0; row < size.y; ++row) {
			for (int column = 0; column < size.x; ++column) {
				patch_posts.push_back(static_cast<std::uint16_t>(random()));
				steps[static_cast<std::size_t>((from.y + row) * count.x + from.x + column)] = patch_posts.back();
			}
		}
		grid.patch({from, from + size}, patch_posts);
	}
	std::size_t wrong_count = 0;
	std::vector<std::uint16_t> before = random_steps(posts, 5);
	for (int row = 0; row < count.y; ++row) {
		for (int column = 0; column < count.x; ++column) {
			const auto at = static_cast<std::size_t>(row * count.x + column);
			wrong_count += grid.at({column, row}) != steps[at] || untouched.at({column, row}) != before[at] ? 1 : 0;
		}
	}
	CHECK(wrong_count == 0);
	CHECK(grid.flattened() == steps);
	CHECK(untouched.flattened() == before);
}

TEST_CASE("post grid: changes are found block by block") {
	const glm::ivec2 count(1000, 1000);
	const std::vector<float> flat(1000000, 1.0F);
	std::vector<float> edited = flat;
	edited[20 * 1000 + 30] = 2.0F;
	edited[23 * 1000 + 34] = 2.0F;
	edited[999 * 1000 + 999] = 2.0F;
	const PostGrid<float> before(count, std::make_shared<const std::vector<float>>(flat));
	const PostGrid<float> after(count, std::make_shared<const std::vector<float>>(edited));
	std::vector<PixelRect> changed_rects;
	after.add_changes(before, changed_rects);
	REQUIRE(changed_rects.size() == 2);
	CHECK(changed_rects[0] == PixelRect{{30, 20}, {35, 24}});
	CHECK(changed_rects[1] == PixelRect{{999, 999}, {1000, 1000}});
}

TEST_CASE("heightfield: a rejected patch has no effect") {
	const glm::ivec2 count(10, 10);
	Heightfield field;
	REQUIRE(field.set_posts(frame_of(count), shared(count, std::vector<float>(100, 0.5F), FloatPosts::units)).ok());
	const float height = field.at({-95.0, 60.0}).height;
	const std::vector<float> four(4, 0.25F);
	const std::vector<float> bad{0.1F, 0.2F, 1.5F, 0.1F};
	const std::vector<std::uint16_t> steps(4, 7);
	const PixelRect rect{{4, 4}, {6, 6}};
	check_refused(field.patch({{4, 4}, {4, 6}}, four), ErrorCode::out_of_range, "rect", 4.0);
	check_refused(field.patch({{-1, 4}, {1, 6}}, four), ErrorCode::out_of_range, "rect", -1.0);
	check_refused(field.patch({{9, 9}, {11, 11}}, four), ErrorCode::out_of_range, "rect", 9.0);
	check_refused(field.patch({{4, 4}, {7, 7}}, four), ErrorCode::wrong_size, "posts", 4.0);
	check_refused(field.patch(rect, bad), ErrorCode::out_of_range, "posts", 1.5);
	CHECK(field.patch(rect, steps).code == ErrorCode::missing);
	CHECK(field.at({-95.0, 60.0}).height == height);
	CHECK(field.patch(rect, four).ok());
	CHECK(field.at({-95.0, 60.0}).height != height);
}

TEST_CASE("heightfield: an error names the column and row of the first invalid sample") {
	std::vector<float> posts(60, 0.5F);
	CHECK(find_refused_post(posts, 12, FloatPosts::units).status.ok());
	posts[31] = -0.01F;
	posts[40] = std::numeric_limits<float>::infinity();
	posts[5] = std::numeric_limits<float>::quiet_NaN(); // A hole is valid.
	const RefusedPost unit = find_refused_post(posts, 12, FloatPosts::units);
	CHECK(unit.status.code == ErrorCode::out_of_range);
	CHECK(unit.post == glm::ivec2(7, 2));
	const RefusedPost meters = find_refused_post(posts, 12, FloatPosts::meters);
	check_refused(meters.status, ErrorCode::not_finite, "posts", infinite_value);
	CHECK(meters.post == glm::ivec2(4, 3));
}

TEST_CASE("heightfield: changed weights are treated as changes to the ground") {
	const glm::ivec2 count(10, 10);
	const auto posts = shared(count, std::vector<std::uint16_t>(100, 5), FloatPosts::meters);
	const HeightfieldFrame frame = frame_of(count);
	const auto weights_of = [](std::uint8_t last) {
		std::vector<std::uint8_t> weights(16, 100);
		weights[10] = last;
		WeightMap map;
		REQUIRE(map.set({4, 4}, 1, weights).ok());
		return map;
	};
	Heightfield before;
	REQUIRE(before.set_posts(frame, posts).ok());
	before.set_weights(weights_of(100));
	Heightfield after = before;
	std::vector<Rect> areas;
	after.set_weights(weights_of(100));
	after.add_changes(before, areas);
	CHECK(areas.empty());
	after.set_weights(weights_of(101));
	after.add_changes(before, areas);
	REQUIRE(areas.size() == 1);
	CHECK(areas[0].min.x == doctest::Approx(frame.area.min.x + frame.area.size().x / 3.0));
	CHECK(areas[0].max.y == doctest::Approx(frame.area.max.y));
	areas.clear();
	after.set_weights({});
	after.add_changes(before, areas);
	REQUIRE(areas.size() == 1);
	CHECK(areas[0].size() == frame.area.size());
}
