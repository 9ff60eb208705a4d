#include "core/drawing/lod_looks.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <set>
#include <vector>

using namespace thicket;

namespace {

constexpr LodStep sharp{false, false};
constexpr LodStep soft{false, true};
constexpr LodStep again{true, true};

LodSettings settings_of(std::vector<double> distances, double fade = 0.1, double sight_end = 0.0) {
	LodSettings settings;
	settings.lod_distances = std::move(distances);
	settings.fade = fade;
	settings.sight_end = sight_end;
	return settings;
}

} // namespace

TEST_CASE("lod looks: consecutive LODs that are drawn alike share one look") {
	const LodLooks looks(settings_of({10.0, 20.0, 30.0, 40.0}), std::vector{soft, again, soft, again, again});
	CHECK(looks.count() == 2);
	CHECK(looks.steps().size() == 5);
	CHECK(looks.appearance_of(0) == 0);
	CHECK(looks.appearance_of(1) == 0);
	CHECK(looks.appearance_of(2) == 1);
	CHECK(looks.appearance_of(9) == 1); // A tile may still display an LOD that its layer no longer has.
	CHECK(looks.beyond_first({0, 1, false}) == 0);
	CHECK(looks.beyond_first({1, 3, false}) == 1);
	CHECK(LodLooks().count() == 0);
}

TEST_CASE("lod looks: in a span, each look fades into the next one, and the last may fade out at the view distance") {
	const LodLooks looks(settings_of({10.0, 20.0}, 0.1, 50.0), std::vector{soft, soft, soft});
	const auto fade_of = [&](LodSpan span, std::size_t index) {
		const LodLooks::Drawn drawn = looks.drawn(span, index);
		CHECK(drawn.look == span.first + index);
		return drawn.fade;
	};
	CHECK_FALSE(fade_of({1, 1, false}, 0)); // The span has one look and is far from any change.
	CHECK(fade_of({0, 1, false}, 0) == LookFade{false, LodEnd::next});
	CHECK(fade_of({0, 1, false}, 1) == LookFade{true, LodEnd::stays});
	CHECK(fade_of({0, 2, true}, 1) == LookFade{true, LodEnd::next});
	CHECK(fade_of({0, 2, true}, 2) == LookFade{true, LodEnd::sight});
	CHECK(fade_of({2, 2, true}, 0) == LookFade{false, LodEnd::sight});
}

TEST_CASE("lod looks: a look that is drawn alone fades only at the view distance, so nothing is missing before it") {
	const LodLooks looks(settings_of({10.0, 20.0}, 0.1, 50.0), std::vector{soft, sharp, soft});
	CHECK(looks.drawn_alone({0, 1, false}, 0).look == 0);
	CHECK_FALSE(looks.drawn_alone({0, 1, false}, 0).fade);
	CHECK(looks.drawn_alone({1, 2, true}, 2).fade == LookFade{false, LodEnd::sight});
	CHECK_FALSE(looks.drawn_alone({1, 1, true}, 1).fade); // The materials of this look cannot fade.
	CHECK(looks.drawn_alone({2, 2, false}, 7).look == 2);
}

TEST_CASE("lod looks: a look that cannot fade never does") {
	const LodLooks looks(settings_of({10.0}, 0.1, 50.0), std::vector{sharp, sharp});
	CHECK_FALSE(looks.fades());
	CHECK_FALSE(looks.drawn({0, 1, true}, 0).fade);
	CHECK_FALSE(looks.drawn({0, 1, true}, 1).fade);
	CHECK(LodLooks(settings_of({10.0}), std::vector{sharp, soft}).fades());
	CHECK_FALSE(LodLooks(settings_of({10.0}, 0.0), std::vector{soft, soft}).fades());
}

TEST_CASE("lod looks: exactly the fades that a span may need have a range") {
	for (const double sight_end : {0.0, 50.0}) {
		const LodLooks looks(settings_of({10.0, 20.0, 30.0}, 0.1, sight_end), std::vector{soft, soft, again, soft});
		for (std::size_t look = 0; look < looks.count(); ++look) {
			const auto ranges = looks.ranges(look);
			std::set<std::size_t> needed;
			for (std::size_t first = 0; first < 4; ++first) {
				for (std::size_t last = first; last < 4; ++last) {
					for (std::size_t index = 0; index <= looks.beyond_first({first, last, false}); ++index) {
						for (const bool ends : {false, sight_end > 0.0}) {
							const LodLooks::Drawn drawn = looks.drawn({first, last, ends}, index);
							if (drawn.look == look && drawn.fade) {
								needed.insert(drawn.fade->index());
							}
						}
					}
				}
			}
			for (std::size_t index = 0; index < ranges.size(); ++index) {
				CHECK((ranges[index] != no_fade) == needed.contains(index));
			}
		}
		CHECK(looks.ranges(1)[LookFade{true, LodEnd::next}.index()] ==
				fade_range(settings_of({10.0, 20.0, 30.0}, 0.1, sight_end), 1, 2, true, LodEnd::next));
	}
}
