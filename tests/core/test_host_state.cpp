// Tests HostState, which holds a game's changes to the instances of layers on which other layers grow.

#include "core/base/instance_id.hpp"
#include "core/near/host_state.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <vector>

using namespace thicket;

TEST_CASE("host state: a copy keeps the removals and the placed instances of one layer") {
	InstanceState state;
	const std::uint64_t felled = pack({4, {3, 5}});
	REQUIRE(state.remove(felled));
	std::uint64_t id = 0;
	REQUIRE(state.add({4, 1, {10.0, 2.0, 10.0}, glm::mat3(2.0F)}, id).ok());
	std::uint64_t other = 0;
	REQUIRE(state.add({9, 0, {11.0, 2.0, 10.0}, glm::mat3(5.0F)}, other).ok());
	const HostState copy(std::make_shared<const SharedState>(state.share()), 4);
	REQUIRE(state.restore(felled));
	REQUIRE(state.remove(id));
	CHECK(copy.removed(felled));
	CHECK_FALSE(copy.removed(pack({4, {3, 6}})));
	CHECK(copy.max_scale() >= 2.0);
	CHECK(copy.max_scale() < 3.0);
	std::vector<HostInstance> placed_hosts;
	for (int call = 1; call <= 2; ++call) {
		REQUIRE(copy.add_placed({{0.0, 0.0}, {20.0, 20.0}}, placed_hosts).ok());
		REQUIRE(placed_hosts.size() == static_cast<std::size_t>(call));
	}
	CHECK(placed_hosts[0].id == id);
	CHECK(placed_hosts[0].mesh == 1);
	CHECK(placed_hosts[0].position == glm::dvec3(10.0, 2.0, 10.0));
	CHECK(placed_hosts[0].basis == glm::dmat3(2.0));
	REQUIRE(copy.add_placed({{11.0, 0.0}, {20.0, 20.0}}, placed_hosts).ok());
	CHECK(placed_hosts.size() == 2);
	const HostState none(std::make_shared<const SharedState>(InstanceState().share()), 4);
	REQUIRE(none.add_placed({{0.0, 0.0}, {20.0, 20.0}}, placed_hosts).ok());
	CHECK(placed_hosts.size() == 2);
	CHECK(none.max_scale() == 0.0);
}
