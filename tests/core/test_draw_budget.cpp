#include "core/drawing/draw_budget.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

using namespace thicket;

namespace {

constexpr std::size_t in_cell = 1000;

TileKey key_of(int x) { return {0, 1, {x, 0}}; }

std::vector<std::uint32_t> ranks_of_cell() {
	std::vector<std::uint32_t> ranks;
	for (std::size_t i = 0; i < in_cell; ++i) {
		ranks.push_back(static_cast<std::uint32_t>((i << 32U) / in_cell));
	}
	return ranks;
}

/// Tiles with one cell each and with equal instances.
class Meadow {
public:
	DrawBudget budget;
	std::vector<CellDrawing> cells;
	std::uint32_t layer = 0;

	explicit Meadow(std::size_t count) : cells(count) {}

	/// Simulates a frame of TileDisplay: redraws all cells if the limits require it, and otherwise
	/// those that were cut.
	void frame() {
		const bool all = budget.begin_frame();
		const std::set<TileKey, TileKeyOrder> cut = budget.take_cut();
		for (std::size_t at = 0; at < cells.size(); ++at) {
			if (all || cut.contains(key_of(static_cast<int>(at)))) {
				draw(at);
			}
		}
	}

	/// Draws a cell. Returns false if the limit thins it.
	bool draw(std::size_t at) {
		const bool is_complete = budget.draw(layer, 1.0, ranks_, cells[at]);
		if (!is_complete) {
			budget.record_cut(key_of(static_cast<int>(at)));
		}
		return is_complete;
	}

	void draw_all() {
		for (std::size_t at = 0; at < cells.size(); ++at) {
			draw(at);
		}
	}

	std::uint64_t drawn_count() const {
		std::uint64_t sum = 0;
		for (const CellDrawing &cell : cells) {
			sum += cell.drawn_count;
		}
		CHECK(sum == budget.amounts().drawn_count);
		return sum;
	}

private:
	std::vector<std::uint32_t> ranks_ = ranks_of_cell();
};

DrawLimits limited_to(std::uint64_t instances) {
	DrawLimits limits;
	limits.max_instances = instances;
	return limits;
}

} // namespace

TEST_CASE("draw budget: quality and hidden layers scale what is drawn") {
	Meadow meadow(10);
	meadow.draw_all();
	CHECK(meadow.drawn_count() == 10000);
	CHECK_FALSE(meadow.budget.begin_frame()); // Nothing has changed.
	DrawLimits limits;
	limits.quality = 0.25;
	limits.hidden_layers = {false, true};
	meadow.budget.set_limits(limits);
	CHECK(meadow.budget.limits() == limits);
	CHECK(meadow.drawn_count() == 10000); // The limits take effect in the next frame.
	meadow.frame();
	CHECK(meadow.drawn_count() == 2500);
	CHECK(meadow.budget.drawn_fraction(LodSettings(), 0.0) == 0.25);
	meadow.layer = 1;
	meadow.draw_all();
	CHECK(meadow.drawn_count() == 0);
	meadow.layer = 7; // Layers beyond the end of the list are visible.
	meadow.draw_all();
	CHECK(meadow.drawn_count() == 2500);
}

TEST_CASE("draw budget: thinning, the density of an LOD and the quality multiply") {
	Meadow meadow(1);
	DrawLimits limits;
	limits.quality = 0.5;
	meadow.budget.set_limits(limits);
	meadow.frame();
	CellDrawing &cell = meadow.cells[0];
	cell.remaining_fraction = 0.5;
	CHECK(meadow.budget.draw(0, 0.5, ranks_of_cell(), cell));
	CHECK(cell.density == 0.25); // The density is the same for every LOD.
	CHECK(cell.drawn_count == 125);
	CHECK(cell.wanted_count == 125);
}

TEST_CASE("draw budget: the limit is never exceeded, and soon thins all cells alike") {
	Meadow meadow(20);
	meadow.budget.set_limits(limited_to(5500));
	CHECK(meadow.budget.begin_frame());
	for (std::size_t at = 0; at < meadow.cells.size(); ++at) {
		CHECK(meadow.draw(at) == (at < 5)); // There is room for five whole cells and half of a sixth.
		CHECK(meadow.drawn_count() <= 5500);
	}
	meadow.frame();
	for (const CellDrawing &cell : meadow.cells) {
		CHECK(cell.drawn_count == doctest::Approx(0.9 * 5500 / 20).epsilon(0.01));
	}
	CHECK(meadow.drawn_count() <= 5500);
	CHECK(meadow.budget.amounts().wanted_count == 20000);
	for (int time = 0; time < 10; ++time) {
		CHECK_FALSE(meadow.budget.begin_frame()); // The budget has settled.
		CHECK(meadow.budget.take_cut().empty());
	}
	meadow.budget.set_limits(limited_to(1000)); // A lower limit is met after one pass over all cells.
	meadow.frame();
	CHECK(meadow.drawn_count() <= 1000);
	meadow.budget.set_limits(limited_to(0));
	meadow.frame();
	CHECK(meadow.drawn_count() == 0);
}

TEST_CASE("draw budget: the fraction changes only if the number of instances changes a lot") {
	Meadow meadow(100);
	meadow.budget.set_limits(limited_to(50000));
	meadow.frame();
	meadow.draw_all();
	meadow.frame();
	const std::uint64_t settled = meadow.drawn_count();
	CHECK(settled == doctest::Approx(45000).epsilon(0.01));
	std::size_t changes = 0;
	for (std::size_t at = 0; at < 20; ++at) { // One by one, a fifth of the tiles is thinned to nothing.
		meadow.cells[at].remaining_fraction = 0.0;
		meadow.draw(at);
		changes += meadow.budget.begin_frame() ? 1 : 0;
	}
	CHECK(changes == 0);
	for (std::size_t at = 20; at < 30; ++at) {
		meadow.cells[at].remaining_fraction = 0.0;
		meadow.draw(at);
		meadow.frame();
	}
	CHECK_MESSAGE(meadow.cells.back().drawn_count > 550, "the remaining tiles use the freed budget");
	CHECK(meadow.drawn_count() <= 50000);
}

TEST_CASE("draw budget: a cell that is cut is drawn again in the next frame, once, until it is whole") {
	Meadow meadow(2);
	meadow.budget.set_limits(limited_to(2100));
	meadow.frame();
	CellDrawing &first = meadow.cells[0];
	meadow.draw_all();
	CHECK(meadow.budget.take_cut().empty());
	// A third tile is added and removed before the fraction adapts.
	DrawAmounts other;
	other.drawn_count = 1500;
	meadow.budget.add(other);
	CHECK_FALSE(meadow.draw(0));
	CHECK_FALSE(meadow.draw(0));
	CHECK(first.drawn_count == 0);
	meadow.budget.remove(other);
	meadow.frame();
	CHECK(first.drawn_count == in_cell);
	CHECK(meadow.budget.take_cut().empty());
	meadow.budget.record_cut(key_of(3));
	meadow.budget.record_cut(key_of(3));
	CHECK(meadow.budget.take_cut().size() == 1);
}

TEST_CASE("draw budget: random tiles and limits settle within the limit, and use most of it") {
	std::mt19937 random(11);
	std::uniform_real_distribution<double> any(0.0, 1.0);
	Meadow meadow(50);
	for (int round = 0; round < 300; ++round) {
		if (round % 10 == 0) {
			meadow.budget.set_limits(limited_to(random() % 60000));
		}
		for (std::size_t at = 0; at < meadow.cells.size(); ++at) {
			if (random() % 3 == 0) {
				meadow.cells[at].remaining_fraction = any(random);
				meadow.draw(at);
			}
		}
		for (int time = 0; time < 3; ++time) {
			meadow.frame();
			CHECK(meadow.drawn_count() <= meadow.budget.limits().max_instances);
		}
		CHECK_FALSE(meadow.budget.begin_frame());
		const auto max_instances = static_cast<double>(meadow.budget.limits().max_instances);
		const auto wanted_count = static_cast<double>(meadow.budget.amounts().wanted_count);
		const auto drawn_count = static_cast<double>(meadow.drawn_count());
		// The 50 allows for rounding to whole instances in each cell.
		CHECK(drawn_count >= std::min(0.69 * max_instances, wanted_count) - 50.0);
	}
}

TEST_CASE("draw budget: adding and removing a tile updates all counts") {
	DrawBudget budget;
	const DrawAmounts tile{10, 400, 3, 5, 7};
	budget.add(tile);
	budget.add(tile);
	budget.remove(tile);
	CHECK(budget.amounts() == tile);
	DrawLimits limits;
	limits.max_multimeshes = 5;
	budget.set_limits(limits);
	CHECK(budget.has_room_for(3)); // The limit applies from the next frame on.
	budget.begin_frame();
	CHECK(budget.max_multimeshes() == 5);
	CHECK(budget.has_room_for(2));
	CHECK_FALSE(budget.has_room_for(3));
	budget.record_cut(key_of(1));
	budget.clear();
	CHECK(budget.amounts() == DrawAmounts());
	CHECK(budget.take_cut().empty());
	CHECK(budget.limits() == limits);
}
