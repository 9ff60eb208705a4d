#include "core/drawing/redraw_queue.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <utility>
#include <vector>

using namespace thicket;

namespace {

Rect square(double x, double y, double size) { return {{x, y}, {x + size, y + size}}; }

std::vector<TileKey> all_later(RedrawQueue &queue) {
	std::vector<TileKey> keys;
	while (const auto key = queue.next_queued()) {
		keys.push_back(*key);
	}
	return keys;
}

} // namespace

TEST_CASE("redraw queue: marks meet the tiles of their layer that they overlap or touch, once") {
	RedrawQueue queue;
	CHECK(queue.take().empty());
	queue.mark(0, square(10.0, 10.0, 0.0)); // This mark is a point.
	queue.mark(0, square(100.0, 100.0, 50.0));
	queue.mark(2, square(-5.0, -5.0, 1.0));
	queue.mark(2, square(-500.0, -5.0, 1.0));
	queue.mark(0, square(-300.0, -10.0, 10.0));
	const RedrawQueue::Marks marks = queue.take();
	CHECK_FALSE(marks.empty());
	CHECK(marks.meet(0, square(0.0, 0.0, 64.0)));
	CHECK_MESSAGE(marks.meet(0, square(10.0, 0.0, 64.0)), "an edge is included");
	CHECK(marks.meet(0, square(128.0, 64.0, 64.0)));
	CHECK_FALSE(marks.meet(0, square(20.0, 20.0, 64.0))); // The tile is between the two marks.
	CHECK_FALSE(marks.meet(0, square(-64.0, 0.0, 64.0)));
	CHECK(marks.meet(2, square(-64.0, -64.0, 64.0)));
	CHECK_FALSE(marks.meet(2, square(-320.0, -64.0, 64.0))); // Only layer 0 has changed there.
	CHECK_FALSE(marks.meet(1, square(0.0, 0.0, 64.0)));
	CHECK_FALSE(marks.meet(2, square(0.0, 0.0, 64.0)));
	CHECK(queue.take().empty());
	CHECK_FALSE(queue.take().meet(0, square(0.0, 0.0, 64.0)));
	queue.mark_all();
	CHECK(queue.take().meet(7, square(1e6, 1e6, 1.0)));
	CHECK(queue.take().empty());
}

TEST_CASE("redraw queue: the version separates uploads from before a change from those after it") {
	RedrawQueue queue;
	const std::uint64_t first = queue.version();
	queue.take();
	CHECK(queue.version() == first); // There was no change.
	queue.mark(0, square(0.0, 0.0, 1.0));
	// The change is not drawn yet. An upload that begins now contains the change, but is redrawn
	// with all other visuals.
	CHECK(queue.version() == first);
	queue.take();
	const std::uint64_t second = queue.version();
	CHECK(second > first);
	queue.begin_later();
	CHECK(queue.version() > second); // The version increases even if no visible tile is affected.
}

TEST_CASE("redraw queue: each postponed tile is returned once, sorted by layer and position, the newest grid first") {
	RedrawQueue queue;
	const std::vector<TileKey> sorted{
			{0, 1, {-3, 9}}, {0, 1, {-3, 10}}, {0, 5, {2, 0}}, {0, 4, {2, 0}}, {1, 2, {-9, 0}}};
	queue.begin_later();
	for (const std::size_t at : {3, 0, 4, 2, 1, 0, 3}) {
		queue.add_later(sorted[at]);
	}
	CHECK(queue.has_queued());
	CHECK(*queue.next_queued() == sorted[0]);
	queue.add_later(sorted[0]); // The tile changes again after it was redrawn.
	CHECK(all_later(queue) == sorted);
	CHECK_FALSE(queue.has_queued());
	CHECK_FALSE(queue.next_queued());
}

TEST_CASE("redraw queue: clearing forgets marks and tiles and keeps the version") {
	RedrawQueue queue;
	queue.mark_all();
	queue.begin_later();
	queue.add_later({0, 1, {0, 0}});
	const std::uint64_t version = queue.version();
	queue.clear();
	CHECK(queue.take().empty());
	CHECK_FALSE(queue.has_queued());
	CHECK(queue.version() == version);
}
