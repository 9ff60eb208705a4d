extends "harness.gd"
## Tests the harness, not the extension. Each of these tests must fail. If one passed, passing tests of the extension would prove nothing.

func test_a_wrong_check() -> void:
	check_equal(1 + 1, 3, "sum")


func test_an_unexpected_error() -> void:
	check(true, "fine")
	PoissonSampler.new().radius = -1.0


func test_an_expected_error_that_is_missing() -> void:
	check_error(["radius"], "nothing")


func test_without_a_check() -> void:
	pass
