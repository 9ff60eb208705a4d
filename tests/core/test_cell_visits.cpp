#include "core/drawing/cell_visits.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <random>
#include <vector>

using namespace thicket;

TEST_CASE("cell visits: a cell is drawn once viewers have moved as far as it allows, and not before") {
	CellVisits visits;
	std::vector<double> margins{5.0, 1.0, 3.0};
	std::vector<std::size_t> drawn_cells;
	const auto draw = [&](std::size_t cell) {
		drawn_cells.push_back(cell);
		return margins[cell];
	};
	const auto visit = [&](double traveled, bool all) {
		drawn_cells.clear();
		return visits.visit(margins.size(), traveled, all, draw);
	};
	CHECK(visit(100.0, true) == 1.0);
	CHECK(drawn_cells == std::vector<std::size_t>{0, 1, 2});
	CHECK(visit(100.5, false) == 0.5);
	CHECK(drawn_cells.empty());
	CHECK(visit(101.0, false) == 1.0);
	CHECK(drawn_cells == std::vector<std::size_t>{1});
	CHECK(visit(104.0, false) == 1.0); // The visit is late: cells 1 and 2 are overdue. Cell 0 is due at 105.
	CHECK(drawn_cells == std::vector<std::size_t>{1, 2});
	CHECK(visit(104.0, true) == 1.0);
	CHECK(drawn_cells.size() == 3);
	margins = {2.0};
	CHECK(visit(104.0, true) == 2.0); // The division has changed.
	margins.clear();
	CHECK(visit(104.0, true) == std::numeric_limits<double>::infinity());
}

TEST_CASE("cell visits: no cell is ever later than its margin if each tile is visited when due") {
	std::mt19937 random(2);
	std::uniform_real_distribution<double> any(0.01, 20.0);
	CellVisits visits;
	std::vector<double> due(16, 0.0);
	double traveled = 0.0;
	std::size_t count = 0;
	const auto draw = [&](std::size_t cell) {
		CHECK(due[cell] <= traveled + 1e-9);
		const double margin = any(random);
		due[cell] = traveled + margin;
		++count;
		return margin;
	};
	double margin = visits.visit(due.size(), traveled, true, draw);
	for (int visit = 0; visit < 1000; ++visit) {
		traveled += margin;
		for (const double at : due) {
			CHECK(at >= traveled - 1e-9);
		}
		margin = visits.visit(due.size(), traveled, false, draw);
		CHECK(margin >= 0.0);
	}
	CHECK(count < 3000); // Most visits draw one cell.
}

TEST_CASE("cell visits: a tile is visited when its first cell or its division is due, but not endlessly") {
	CHECK(visit_margin(10.0, 0.0, 30.0) == 10.0);
	CHECK(visit_margin(10.0, 0.0, 4.0) == 4.0);
	CHECK(visit_margin(0.0, 0.0, 30.0) > 0.0); // The distance is exactly where a change occurs.
	CHECK(visit_margin(0.0, 0.0, 30.0) <= 0.01);
	CHECK(visit_margin(0.5, 32.0, 30.0) == 4.0); // The margin is at least an eighth of a cell.
	CHECK(visit_margin(5.0, 32.0, 30.0) == 5.0);
	CHECK(visit_margin(0.5, 32.0, 2.0) == 2.0);
	constexpr double infinity = std::numeric_limits<double>::infinity();
	CHECK(visit_margin(infinity, 0.0, infinity) == infinity);
}
