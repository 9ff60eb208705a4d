// Growth of cost: random kinds of input, each at two sizes, in steps and not by a clock. What takes four times the input must not take
// more than six times the steps; n log n stays below five, and a quadratic cost comes to sixteen.
//   growth [ROUNDS = 3] [SEED = 1]      rounds of all cases, each with another seed
//   growth - SEED [CASE]                the one seed that a failure has named, with figures; of all cases or of one

#include "tests/cost/steps.hpp"

#include "core/base/instance_id.hpp"
#include "core/rules/painted_mask.hpp"
#include "core/rules/polyline.hpp"
#include "core/rules/shapes.hpp"
#include "core/state/instance_state.hpp"
#include "core/state/pending_diff.hpp"
#include "core/state/state_changes.hpp"
#include "core/terrain/mesh_surface.hpp"
#include "core/terrain/triangle_terrain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace thicket;

using Changes = std::vector<InstanceChange>;
using Stored = std::vector<std::uint8_t>;
using Points = std::vector<glm::dvec2>;

constexpr std::size_t small_size = 1024;
constexpr std::size_t growth = 4;
constexpr double most_growth = 6.0;

/// What counts as much at any size, so that it does not hide how the rest grows.
constexpr std::uint64_t free_steps = 20000;

/// A kind of input, of any size.
class Recipe {
public:
	explicit Recipe(std::uint64_t seed) :
			seed_(seed), random_(seed), kind_(static_cast<Kind>(below(kinds))), step_(std::exp2(number(-6.0, 6.0))) {
		stride_ = below(3) == 0 ? std::uint64_t{1} << below(40) : 1 + below(1000);
	}

	std::uint64_t below(std::uint64_t count) { return random_() % count; }

	double number(double from, double to) {
		return from + (to - from) * static_cast<double>(random_() >> 11) * 0x1p-53;
	}

	/// Points in an order that is as hard as any: all at one place, in turns at two, along lines, at random, on a spiral or a grid.
	Points points(std::size_t count) const {
		std::mt19937_64 own(seed_);
		const auto any = [&own] {
			return static_cast<double>(own() >> 11) * 0x1p-53 - 0.5;
		};
		Points result;
		for (std::size_t i = 0; i < count; ++i) {
			const auto at = static_cast<double>(i);
			switch (kind_) {
				case Kind::one_place: result.emplace_back(3.0, 4.0); break;
				case Kind::two_places: result.emplace_back(i % 2 == 0 ? -step_ : step_, 0.0); break;
				case Kind::line: result.emplace_back(step_ * at, 0.0); break;
				case Kind::line_back: result.emplace_back(step_ * (static_cast<double>(count) - at), step_); break;
				case Kind::crowd: result.emplace_back(step_ * any(), step_ * any()); break;
				case Kind::wide: result.emplace_back(1e5 * any(), 1e5 * any()); break;
				case Kind::star:
					result.emplace_back(i % 2 == 0 ? 0.0 : 1e3 * any(), i % 2 == 0 ? 0.0 : 1e3 * any());
					break;
				case Kind::comb: result.emplace_back(step_ * at, (i / 2) % 2 == 0 ? 0.0 : 1e3); break;
				default:
					result.emplace_back(step_ * static_cast<double>(i % 32), step_ * static_cast<double>(i / 32));
					break;
			}
		}
		return result;
	}

	/// Ids of points of sets, all different.
	std::vector<std::uint64_t> ids(std::size_t count) const {
		std::vector<std::uint64_t> result;
		for (std::size_t i = 0; i < count; ++i) {
			const std::uint64_t number = stride_ * (i + 1);
			const auto layer = static_cast<std::uint64_t>(kind_) % 3 == 0 ? i % 5 : 0;
			result.push_back(layer << 48 | (number & 0xffffffffffff));
		}
		std::ranges::sort(result);
		result.erase(std::unique(result.begin(), result.end()), result.end());
		return result;
	}

	const char *name() const {
		static constexpr std::array<const char *, kinds> names = {
				"one place", "two places", "line", "line back", "crowd", "wide", "star", "comb", "grid"};
		return names[static_cast<std::size_t>(kind_)];
	}

	std::uint64_t seed() const { return seed_; }
	double step() const { return step_; }

private:
	enum class Kind : std::uint8_t { one_place, two_places, line, line_back, crowd, wide, star, comb, grid };
	static constexpr std::size_t kinds = 9;

	std::uint64_t seed_;
	std::mt19937_64 random_;
	Kind kind_;
	double step_;
	std::uint64_t stride_ = 1;
};

void need(const Status &status) {
	if (!status.ok()) {
		std::fprintf(stderr, "growth: an input was refused: %s\n", describe(status).c_str());
		std::abort();
	}
}

AddedInstance instance_at(glm::dvec2 position) {
	AddedInstance instance;
	instance.position = {position.x, 0.0, position.y};
	return instance;
}

std::vector<AddedInstance> instances(const Recipe &recipe, std::size_t count) {
	std::vector<AddedInstance> result;
	for (const glm::dvec2 &position : recipe.points(count)) {
		result.push_back(instance_at(position));
	}
	return result;
}

InstanceState felled(const Recipe &recipe, std::size_t count, double until = 0.0) {
	InstanceState state;
	for (const std::uint64_t id : recipe.ids(count)) {
		need(state.remove(id, until).status);
	}
	return state;
}

InstanceState planted(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	std::vector<std::uint64_t> ids;
	Changes changes;
	need(state.add_all(instances(recipe, count), ids, changes));
	return state;
}

Stored diff_of(const InstanceState &state) {
	Stored bytes;
	need(state.diff_since(0, bytes));
	return bytes;
}

std::uint64_t steps_of(const std::function<void()> &work) {
	const std::uint64_t before = cost::steps();
	work();
	return cost::steps() - before;
}

/// A case: the steps of what it is about, for an input of a size.
struct Case {
	const char *name;
	std::uint64_t (*run)(const Recipe &recipe, std::size_t count);
};

std::uint64_t place_all(const Recipe &recipe, std::size_t count) {
	const std::vector<AddedInstance> all = instances(recipe, count);
	InstanceState state;
	std::vector<std::uint64_t> ids;
	Changes changes;
	return steps_of([&] { need(state.add_all(all, ids, changes)); });
}

std::uint64_t place_each(const Recipe &recipe, std::size_t count) {
	const std::vector<AddedInstance> all = instances(recipe, count);
	InstanceState state;
	std::uint64_t id = 0;
	return steps_of([&] {
		for (const AddedInstance &instance : all) {
			need(state.add(instance, id));
		}
	});
}

std::uint64_t take_away_and_place_again(const Recipe &recipe, std::size_t count) {
	InstanceState state = planted(recipe, count);
	const std::vector<AddedInstance> all = instances(recipe, count);
	const std::vector<std::uint64_t> ids = state.added_ids();
	std::uint64_t id = 0;
	return steps_of([&] {
		for (std::size_t i = 0; i < count; ++i) {
			need(state.remove(ids[i]).status);
			need(state.add(all[i], id));
		}
	});
}

std::uint64_t move_each(const Recipe &recipe, std::size_t count) {
	InstanceState state = planted(recipe, count);
	const Points to = recipe.points(2 * count);
	const std::vector<std::uint64_t> ids = state.added_ids();
	Changes changes;
	return steps_of([&] {
		for (std::size_t i = 0; i < count; ++i) {
			std::uint64_t id = 0;
			need(state.move(ids[i], instance_at(to[2 * count - 1 - i]), id, changes));
		}
	});
}

std::uint64_t remove_each(const Recipe &recipe, std::size_t count) {
	return steps_of([&] { felled(recipe, count); });
}

std::uint64_t remove_and_restore(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	return steps_of([&] {
		for (std::size_t i = 0; i < count; ++i) {
			need(state.remove(ids[i % ids.size()]).status);
			need(state.restore(ids[i % ids.size()]).status);
		}
	});
}

std::uint64_t grow_at_once(const Recipe &recipe, std::size_t count) {
	InstanceState state = felled(recipe, count, 10.0);
	Changes changes;
	return steps_of([&] { need(state.advance(20.0, changes)); });
}

std::uint64_t grow_one_by_one(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	double until = 0.0;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	for (const std::uint64_t id : ids) {
		need(state.remove(id, until += 1.0).status);
	}
	Changes changes;
	return steps_of([&] {
		for (std::size_t i = 0; i < ids.size(); ++i) {
			need(state.advance(1.0, changes));
		}
	});
}

std::uint64_t postpone(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	double until = 1.0;
	return steps_of([&] {
		for (std::size_t i = 0; i < 4 * count; ++i) {
			need(state.remove(ids[i % ids.size()], until += 1.0).status);
		}
	});
}

std::uint64_t write_data(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const Stored data(24, 7);
	return steps_of([&] {
		for (const std::uint64_t id : recipe.ids(count)) {
			need(state.set_data(id, data));
		}
		Stored bytes;
		need(state.save(bytes));
	});
}

std::uint64_t save_and_load(const Recipe &recipe, std::size_t count) {
	const InstanceState state = felled(recipe, count, 5.0);
	return steps_of([&] {
		Stored bytes;
		need(state.save(bytes));
		InstanceState other;
		Changes changes;
		need(other.load(bytes, changes));
	});
}

std::uint64_t apply_diffs(const Recipe &recipe, std::size_t count) {
	const Stored removals = diff_of(felled(recipe, count));
	const Stored placed = diff_of(planted(recipe, count));
	InstanceState state;
	Changes changes;
	return steps_of([&] {
		need(state.apply(removals, changes));
		need(state.apply(placed, changes));
	});
}

std::uint64_t send_each_change(const Recipe &recipe, std::size_t count) {
	InstanceState state;
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	InstanceState peer;
	Changes changes;
	return steps_of([&] {
		for (const std::uint64_t id : ids) {
			const std::uint64_t before = state.revision();
			need(state.remove(id).status);
			Stored bytes;
			need(state.diff_since(before, bytes));
			need(peer.apply(bytes, changes));
		}
	});
}

std::uint64_t take_back(const Recipe &recipe, std::size_t count) {
	InstanceState state = planted(recipe, count);
	const std::vector<std::uint64_t> ids = state.added_ids();
	Stored step;
	Changes changes;
	return steps_of([&] {
		need(state.diff_of(ids, step));
		for (const std::uint64_t id : ids) {
			need(state.remove(id).status);
		}
		need(state.apply(step, changes));
	});
}

std::uint64_t merge_two(const Recipe &recipe, std::size_t count) {
	InstanceState state = felled(recipe, count);
	const InstanceState other = planted(recipe, count);
	Changes changes;
	return steps_of([&] { need(state.merge(other, changes)); });
}

std::uint64_t work_beside_a_diff(const Recipe &recipe, std::size_t count) {
	InstanceState state = felled(recipe, count);
	const Stored bytes = diff_of(planted(recipe, count));
	const std::vector<std::uint64_t> ids = recipe.ids(count);
	return steps_of([&] {
		std::shared_ptr<PendingDiff> pending;
		need(state.queue_diff(bytes, pending));
		for (const std::uint64_t id : ids) {
			need(state.restore(id).status);
		}
		pending->work();
		StateChanges changes;
		need(state.finish_pending_diff(changes));
	});
}

std::uint64_t queue_many_diffs(const Recipe &recipe, std::size_t count) {
	constexpr std::size_t divisor = 8; // A diff is many steps.
	std::vector<Stored> diffs;
	InstanceState other;
	for (const std::uint64_t id : recipe.ids(count / divisor)) {
		const std::uint64_t before = other.revision();
		need(other.remove(id).status);
		need(other.diff_since(before, diffs.emplace_back()));
	}
	InstanceState state;
	return steps_of([&] {
		std::vector<std::shared_ptr<PendingDiff>> pending(diffs.size());
		for (std::size_t i = 0; i < diffs.size(); ++i) {
			need(state.queue_diff(diffs[i], pending[i]));
		}
		for (const std::shared_ptr<PendingDiff> &diff : pending) {
			diff->work();
			StateChanges changes;
			need(state.finish_pending_diff(changes));
		}
	});
}

/// Dabs of one size. Pixels are meters.
PaintedMask painted(const Recipe &recipe, std::size_t count) {
	PaintedMask mask;
	need(mask.reset(1.0, 0.0));
	for (const glm::dvec2 &center : recipe.points(count)) {
		Rect changed;
		Brush brush;
		brush.center = center;
		brush.radius = 3.0;
		need(mask.paint(brush, changed));
	}
	return mask;
}

constexpr std::size_t dabs_divisor = 8; // A dab is many steps.

std::uint64_t paint(const Recipe &recipe, std::size_t count) {
	return steps_of([&] { painted(recipe, count / dabs_divisor); });
}

std::uint64_t save_and_load_mask(const Recipe &recipe, std::size_t count) {
	const PaintedMask mask = painted(recipe, count / dabs_divisor);
	return steps_of([&] {
		PaintedMask loaded;
		need(loaded.from_bytes(mask.to_bytes()));
	});
}

/// Positions that stay the same at every size of an input.
Points fixed_places() {
	Points places;
	for (int i = 0; i < 16; ++i) {
		places.emplace_back(-500.0 + 70.0 * i, 3.0 * i);
	}
	return places;
}

void question(const ShapeSet &set) {
	for (const glm::dvec2 &place : fixed_places()) {
		std::vector<std::uint32_t> near;
		need(set.near({place - 1.0, place + 1.0}, near));
		static_cast<void>(set.density(near, {place.x, 0.0, place.y}));
	}
}

std::uint64_t outline(const Recipe &recipe, std::size_t count, ShapeKind kind) {
	Shape shape;
	shape.kind = kind;
	shape.half_size.x = 2.0;
	shape.falloff = 1.0;
	shape.outline = recipe.points(count);
	return steps_of([&] {
		ShapeSet set;
		need(set.set({shape}));
		question(set);
	});
}

std::uint64_t polygon(const Recipe &recipe, std::size_t count) { return outline(recipe, count, ShapeKind::polygon); }

std::uint64_t path(const Recipe &recipe, std::size_t count) { return outline(recipe, count, ShapeKind::path); }

std::uint64_t many_shapes(const Recipe &recipe, std::size_t count) {
	std::vector<Shape> shapes;
	for (const glm::dvec2 &center : recipe.points(count)) {
		Shape &shape = shapes.emplace_back();
		shape.kind = ShapeKind::sphere;
		shape.center = {center.x, 0.0, center.y};
		shape.half_size.x = 5.0;
	}
	return steps_of([&] {
		ShapeSet set;
		need(set.set(shapes));
		question(set);
	});
}

std::uint64_t simplify(const Recipe &recipe, std::size_t count) {
	const Points line = recipe.points(count);
	return steps_of([&] { static_cast<void>(simplified(line, recipe.step())); });
}

/// Triangles at the points of a recipe, or through three of them, which makes them long.
std::uint64_t mesh(const Recipe &recipe, std::size_t count, bool longish) {
	const Points points = recipe.points(3 * count);
	std::vector<glm::dvec3> corners;
	for (std::size_t i = 0; i < count; ++i) {
		const double height = static_cast<double>(i % 7);
		for (std::size_t corner = 0; corner < 3; ++corner) {
			const glm::dvec2 own = longish ? points[3 * i + corner] : points[i];
			corners.emplace_back(own.x + (corner == 1 ? 1.0 : 0.0), height, own.y + (corner == 2 ? 1.0 : 0.0));
		}
	}
	return steps_of([&] {
		TriangleTerrain terrain;
		need(terrain.set(corners));
		std::vector<Ground> ground(fixed_places().size());
		need(terrain.sample(fixed_places(), ground));
	});
}

std::uint64_t mesh_of_small(const Recipe &recipe, std::size_t count) { return mesh(recipe, count, false); }

std::uint64_t mesh_of_long(const Recipe &recipe, std::size_t count) { return mesh(recipe, count, true); }

constexpr std::array cases = {
		Case{"state: place all", place_all},
		Case{"state: place each", place_each},
		Case{"state: take away, place again", take_away_and_place_again},
		Case{"state: move each", move_each},
		Case{"state: remove each", remove_each},
		Case{"state: remove and restore", remove_and_restore},
		Case{"state: all grow at once", grow_at_once},
		Case{"state: one after the other grows", grow_one_by_one},
		Case{"state: growth is put off", postpone},
		Case{"state: data of each", write_data},
		Case{"state: save and load", save_and_load},
		Case{"state: apply diffs", apply_diffs},
		Case{"state: send each change", send_each_change},
		Case{"state: undo", take_back},
		Case{"state: merge", merge_two},
		Case{"state: work beside a diff", work_beside_a_diff},
		Case{"state: many diffs under way", queue_many_diffs},
		Case{"mask: dabs", paint},
		Case{"mask: save and load", save_and_load_mask},
		Case{"region: polygon", polygon},
		Case{"region: path", path},
		Case{"region: many shapes", many_shapes},
		Case{"region: simplify a line", simplify},
		Case{"mesh: small triangles", mesh_of_small},
		Case{"mesh: long triangles", mesh_of_long},
};

/// False, with a line about it, for a case that grows too fast.
bool check(const Case &which, std::uint64_t seed, bool verbose) {
	const Recipe recipe(seed);
	static_cast<void>(which.run(recipe, small_size)); // What is made once, tables of the library for instance.
	const std::uint64_t few = which.run(recipe, small_size) + free_steps;
	const std::uint64_t many = which.run(recipe, growth * small_size) + free_steps;
	const double ratio = static_cast<double>(many) / static_cast<double>(few);
	const bool held = ratio <= most_growth;
	if (!held || verbose) {
		std::printf("%s, %s: %llu steps for %zu, %llu for %zu, %.1f times as many%s (again with: - %llu)\n", which.name,
				recipe.name(), static_cast<unsigned long long>(few), small_size, static_cast<unsigned long long>(many),
				growth * small_size, ratio, held ? "" : ": TOO MANY", static_cast<unsigned long long>(seed));
	}
	return held;
}

} // namespace

int main(int argument_count, char **arguments) {
	const bool one = argument_count > 2 && std::strcmp(arguments[1], "-") == 0;
	const int rounds = one || argument_count < 2 ? (one ? 1 : 3) : std::atoi(arguments[1]);
	const char *wanted = one && argument_count > 3 ? arguments[3] : nullptr;
	const std::uint64_t seed = argument_count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1;
	int failed = 0;
	for (int round = 0; round < rounds; ++round) {
		for (const Case &which : cases) {
			const bool chosen = wanted == nullptr || std::strcmp(which.name, wanted) == 0;
			failed += !chosen || check(which, seed + static_cast<std::uint64_t>(round), one) ? 0 : 1;
		}
	}
	std::printf("%zu cases, %d rounds, %d failed\n", cases.size(), rounds, failed);
	return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
