from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from tests.helpers.calls.refused import assert_names, refused

Data = dict[str, Any]
Change = Callable[[Data], object]

GOOD: Data = {
    "name": "try_out",
    "description": "A room to break.",
    "duration_s": 20.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0, "doors": [{"wall": "north", "along_m": 5.0}]},
    "things": [
        {"kind": "table", "at_m": [6.0, -1.5]},
        {"kind": "monitor", "on_top_of": "table_1"},
        {"kind": "chair", "at_m": [4.0, -2.0]},
        {"kind": "radiator", "wall": "east", "along_m": 1.5},
    ],
    "people": [
        {"name": "anna", "path": [{"at_m": [3.0, 1.0]}, {"at_m": [5.0, 1.0]}, {"at_m": [5.0, 4.0]}]},
        {"name": "ben", "path": [{"at_m": [3.0, -1.0], "face": "anna"}], "enter_s": 2.0, "leave_s": 9.0},
    ],
    "robot": {"at_m": [1.0, 0.0]},
}


def refusal(data: Data, folder: Path = Path("/nowhere")) -> str:
    with pytest.raises(BadInput) as caught:
        parse_scenario(data, source="my.yaml", folder=folder)
    assert_names(str(caught.value), "my.yaml: ")
    return str(caught.value)


def test_the_scenario_that_the_other_tests_break_is_good() -> None:
    assert parse_scenario(GOOD, source="my.yaml", folder=Path("/nowhere")).world(0).people[1].name == "ben"


def camera(**keys: Any) -> Change:
    """Give the robot a further camera."""
    return lambda d: d["robot"].update(cameras={"rear": {"kind": "thermal", **keys}})


MISTAKES: dict[str, tuple[Change, tuple[str, ...]]] = {
    "a group without a way": (
        lambda d: d.update(groups=[{"names": ["eve", "fay"], "path": [{"at_m": [3.0, 2.0]}]}]),
        ("groups[0].path: must have at least 2 entries",),
    ),
    "two in one place": (
        lambda d: d["people"].append({"name": "carl", "path": [{"at_m": [3.0, 1.0]}, {"at_m": [5.0, 1.0]}]}),
        ("people[2].path[0].at_m: 'carl' starts at the same time and place as 'anna'",),
    ),
    "a group of one": (
        lambda d: d["people"][0].update(group="us"),
        ("people[0].group: 'us' has only one member, 'anna'",),
    ),
    "a fault when all is over": (
        lambda d: d.update(faults=[{"kind": "camera_black", "from_s": 20.0}]),
        ("faults[0].from_s: 20 must be before the end, duration_s 20",),
    ),
    "a script without commands": (
        lambda d: d.update(robot={"at_m": [1.0, 0.0], "behaviour": "scripted"}),
        ("robot.commands: a scripted robot needs at least one", "or use behaviour 'stand'"),
    ),
    "a route through a wall": (
        lambda d: d.update(
            things=[{"kind": "block", "at_m": [4.0, 0.0], "size_m": [0.3, 5.8, 2.0]}],
            people=[{"name": "eve", "route": True, "path": [{"at_m": [2.0, 1.0]}, {"at_m": [6.0, 1.0]}]}],
        ),
        ("people[0].path[1].at_m: no gap of 0.4 m leads from (2, 1) to (6, 1)",),
    ),
    "a drive to no goal": (
        lambda d: d["robot"].update(behaviour="go_to"),
        ("robot.goal_m: behaviour 'go_to' needs one, such as [6.0, 1.5]",),
    ),
    "a goal in a table": (
        lambda d: d["robot"].update(goal_m=[6.0, -1.5]),
        ("robot.goal_m: (6, -1.5) is in or within 0.27 m of 'table_1'; move it away",),
    ),
    "a goal without a way": (
        lambda d: d.update(
            things=[{"kind": "block", "at_m": [4.0, 0.0], "size_m": [0.3, 5.8, 2.0]}],
            people=[],
            robot={"at_m": [1.0, 0.0], "goal_m": [6.0, 0.0]},
        ),
        ("robot.goal_m: no gap of 0.54 m leads the robot from (1, 0) to (6, 0)",),
    ),
    "a tracker of one's own": (
        lambda d: d["robot"].update(tracker="mine:Mine"),
        ("robot.tracker: 'mine:Mine' is your own class", "--tracker mine:Mine"),
    ),
    "a person named as a thing": (
        lambda d: d["people"][1].update(name="table_1"),
        ("people[1]: name 'table_1' is used by an object in the place",),
    ),
    "a person named as a wall": (
        lambda d: d["people"][1].update(name="wall_east"),
        ("people[1]: name 'wall_east' is used by an object in the place",),
    ),
    "a person named as the border": (
        lambda d: d["people"][1].update(name="border"),
        ("people[1]: name 'border' is reserved",),
    ),
    "a camera whose images would lie where watch writes": (
        lambda d: d["robot"].update(cameras={"scene": {"kind": "colour"}}),
        ("robot.cameras.scene: the name is reserved for files of a run",),
    ),
    "less than a frame": (
        lambda d: d.update(duration_s=0.03, people=[]),
        ("duration_s: 0.03 is shorter than a frame", "1/15 s"),
    ),
    "unknown reaction": (
        lambda d: d["people"][0].update(reacts={"as": "curios"}),
        ("people[0].reacts.as: unknown as 'curios'", "did you mean 'curious'?"),
    ),
    "misspelt key of a reaction": (
        lambda d: d["people"][0].update(reacts={"as": "wary", "form_m": 3.0}),
        ("people[0].reacts: unknown key 'form_m'", "did you mean 'from_m'?"),
    ),
    "distance that a reaction does not take": (
        lambda d: d["people"][0].update(reacts={"as": "surprised", "keep_m": 1.0}),
        ("people[0].reacts: keep_m 1: not used by a person who is surprised",),
    ),
    "reaction that begins too late to keep its distance": (
        lambda d: d["people"][0].update(reacts={"as": "wary", "keep_m": 6.0}),
        ("people[0].reacts: keep_m 6 must be at most from_m, 5",),
    ),
    "leader who never goes on": (
        lambda d: d["people"][0].update(leads={"waits_beyond_m": 3.0, "goes_on_within_m": 3.0}),
        ("people[0].leads: goes_on_within_m 3 must be less than waits_beyond_m, 3",),
    ),
    "leader who reacts": (
        lambda d: d["people"][0].update(leads={}, reacts={"as": "wary"}),
        ("people[0].leads: a person who leads the robot cannot also react to it",),
    ),
    "wait for a robot that would be inside": (
        lambda d: d["people"][0]["path"][0].update(until_robot_within_m=0.1),
        ("people[0].path[0].until_robot_within_m: must be at least 0.8, got 0.1",),
    ),
    "group whose paths cannot be compared": (
        lambda d: [person.update(group="us") for person in d["people"]],
        ("people[1].group: 'us': 'ben' has 1 waypoints and 'anna' 3; all members need the same number",),
    ),
    "floor that mirrors more than there is": (
        lambda d: d["place"].update(floor_shine=1.2),
        ("place.floor_shine: must be at most 1, got 1.2",),
    ),
    "thing that mirrors less than nothing": (
        lambda d: d["things"][0].update(shine=-0.1),
        ("things[0].shine: must be at least 0, got -0.1",),
    ),
    "thing without a kind": (
        lambda d: d["things"][0].pop("kind"),
        ("things[0]: missing key 'kind'; choose from bear, bench, bicycle,", "vending_machine, window"),
    ),
    "camera where cameras used to be": (
        lambda d: d["robot"].update(thermal={"netd_k": 0.1}),
        ("robot: 'thermal' is a camera", "write cameras: {thermal: {kind: thermal, ...}}"),
    ),
    "camera without a kind": (
        lambda d: d["robot"].update(cameras={"rear": {"yaw_deg": 180.0}}),
        ("robot.cameras.rear: missing key 'kind'; choose from colour, depth, laser, panorama, thermal",),
    ),
    "camera without a kind whose name is one": (
        lambda d: d["robot"].update(cameras={"thermal": {"pitch_deg": -6.0}}),
        ("robot.cameras.thermal: missing key 'kind'; choose from colour, depth, laser, panorama, thermal",),
    ),
    "camera that is called as its kind": (
        lambda d: d["robot"].update(cameras={"colour": {"kind": "colour", "pich_deg": -6.0}}),
        ("robot.cameras.colour: unknown key 'pich_deg'; did you mean 'pitch_deg'?",),
    ),
    "camera of an unknown kind": (
        camera(kind="termal"),
        ("robot.cameras.rear: unknown kind 'termal'", "did you mean 'thermal'?"),
    ),
    "misspelt key of a camera": (
        camera(netd_c=0.1),
        ("robot.cameras.rear: unknown key 'netd_c'", "did you mean 'netd_k'?"),
    ),
    "camera out of its limits": (camera(netd_k=-1.0), ("robot.cameras.rear.netd_k: must be at least 0",)),
    "unknown gain": (camera(gain="plato"), ("robot.cameras.rear.gain: ", "'plato'", "'plateau'")),
    "span that is empty": (
        camera(lowest_c=36.0),
        ("robot.cameras.rear.highest_c: 36.0 must be more than lowest_c, 36.0",),
    ),
    "tails that clip too much": (camera(tail_percent=2.0), ("robot.cameras.rear.tail_percent: ", "0.45")),
    "shutter that never opens": (
        camera(shutter_every_s=0.2),
        ("robot.cameras.rear.shutter_every_s: 0.2 must be more than shutter_lasts_s, 0.4, or 0",),
    ),
    "compression of no quality": (camera(jpeg_quality=0), ("robot.cameras.rear.jpeg_quality: ", "1")),
    "preset of another kind of camera": (
        camera(preset="kinect"),
        ("robot.cameras.rear.preset: ", "uncooled"),
    ),
    "rate that does not divide": (
        camera(rate_hz=4),
        ("robot.cameras.rear.rate_hz: 4 must divide the control rate, 15 Hz; choose from 1, 3, 5, 15",),
    ),
    "slow camera of the tracker": (
        lambda d: d["robot"].update(cameras={"colour": {"kind": "colour", "rate_hz": 5}}),
        ("robot.cameras.colour.rate_hz: must be 15",),
    ),
    "camera of the tracker of another kind": (
        lambda d: d["robot"].update(cameras={"thermal": {"kind": "colour"}}),
        ("robot.cameras.thermal.kind: must be 'thermal'",),
    ),
    "name that run folders have for themselves": (
        lambda d: d["robot"].update(cameras={"truth": {"kind": "thermal"}}),
        ("robot.cameras.truth: the name is reserved",),
    ),
    "name of another camera's images": (
        lambda d: d["robot"].update(cameras={"thermal16": {"kind": "colour"}}),
        ("robot.cameras: camera 'thermal16': another camera has images of that name",),
    ),
    "camera name that is none": (
        lambda d: d["robot"].update(cameras={"Rear view": {"kind": "thermal"}}),
        ("robot.cameras.Rear view", "is not a name"),
    ),
    "images that are too large for a tracker": (
        camera(width_px=4096, height_px=4096),
        ("robot.cameras.rear: 4096 x 4096 pixels are too many; at most 8388608",),
    ),
    "colour camera that looks away": (
        lambda d: d["robot"].update(cameras={"colour": {"kind": "colour", "yaw_deg": 180.0}}),
        ("robot.cameras: the colour camera does not see the plane 4.0 m",),
    ),
    "misspelt key": (
        lambda d: d["people"][0]["path"][1].update(speed_ms=1.0),
        ("people[0].path[1]: ", "'speed_ms'", "'speed_m_s'"),
    ),
    "misspelt key at the top": (
        lambda d: d.update(peple=[]),
        ("'peple'", "'people'"),
    ),
    "misspelt key of a place": (
        lambda d: d["place"].update(lenght_m=3.0),
        ("place: ", "'lenght_m'", "'length_m'"),
    ),
    "missing key": (
        lambda d: d["place"].pop("width_m"),
        (
            "place: ",
            "'width_m'",
        ),
    ),
    "missing kind": (
        lambda d: d["place"].pop("kind"),
        (
            "place: ",
            "'kind'",
        ),
    ),
    "unknown place": (lambda d: d["place"].update(kind="rooom"), ("place", "'rooom'", "'room'")),
    "unknown thing": (
        lambda d: d["things"][3].update(kind="radiatr"),
        ("things[3].kind: ", "'radiatr'", "'radiator'"),
    ),
    "unknown garment": (
        lambda d: d["people"][0].update(clothes={"top": "t_shrt"}),
        ("people[0].clothes.top: ", "'t_shrt'", "'t_shirt'"),
    ),
    "unknown colour": (
        lambda d: d["people"][0].update(clothes={"top_colour": "rad"}),
        ("people[0].clothes.top_colour: ", "'rad'", "'red'"),
    ),
    "unknown colour of a wall": (
        lambda d: d["place"].update(colours={"walls": "gren"}),
        ("place.colours.walls: ", "'gren'", "'green'"),
    ),
    "unknown posture": (
        lambda d: d["people"][1]["path"][0].update(posture="siting"),
        ("people[1].path[0].posture: ", "'siting'", "'sitting'"),
    ),
    "unknown wall of a door": (
        lambda d: d["place"]["doors"][0].update(wall="nort"),
        ("place.doors[0].wall: ", "'nort'", "'north'"),
    ),
    "unknown wall of a thing": (
        lambda d: d["things"][3].update(wall="eastt"),
        ("things[3].wall: ", "'eastt'", "'east'"),
    ),
    "unknown wall of a temperature": (
        lambda d: d["place"].update(temperatures={"single_walls_c": {"up": 20.0}}),
        ("place.temperatures.single_walls_c: ", "'up'", "east, north, south, west"),
    ),
    "unknown thing below": (
        lambda d: d["things"][1].update(on_top_of="tabel_1"),
        ("things[1].on_top_of: ", "'tabel_1'", "'table_1'"),
    ),
    "unknown face": (
        lambda d: d["people"][1]["path"][0].update(face="ana"),
        ("people[1].path[0].face: ", "'ana'", "'anna'"),
    ),
    "NaN": (
        lambda d: d.update(duration_s=float("nan")),
        (
            "duration_s: ",
            "finite",
            "nan",
        ),
    ),
    "infinity": (
        lambda d: d["robot"].update(at_m=[float("inf"), 0.0]),
        (
            "robot.at_m[0]: ",
            "finite",
            "inf",
        ),
    ),
    "negative speed": (
        lambda d: d["people"][0]["path"][1].update(speed_m_s=-1.0),
        (
            "people[0].path[1].speed_m_s: ",
            "0.1",
            "got -1.0",
        ),
    ),
    "no duration": (
        lambda d: d.update(duration_s=0),
        (
            "duration_s: ",
            "than 0",
            "got 0",
        ),
    ),
    "number as text": (
        lambda d: d.update(duration_s="20"),
        (
            "duration_s: ",
            "number",
            "'20'",
        ),
    ),
    "yes as a number": (
        lambda d: d.update(duration_s=True),
        (
            "duration_s: ",
            "number",
            "True",
        ),
    ),
    "point of one number": (lambda d: d["robot"].update(at_m=[1.0]), ("robot.at_m[1]: ",)),
    "no path": (
        lambda d: d["people"][0].update(path=[]),
        (
            "people[0].path: ",
            "at least 1 ",
        ),
    ),
    "leave before enter": (
        lambda d: d["people"][1].update(leave_s=1.0),
        (
            "people[1].leave_s: 1 ",
            "enter_s 2",
        ),
    ),
    "enter after the end": (
        lambda d: d["people"][0].update(enter_s=20.0),
        ("people[0].enter_s: 20 ",),
    ),
    "two people of one name": (
        lambda d: d["people"][1].update(name="anna"),
        (
            "people[1]: ",
            "'anna'",
            "people[0]",
        ),
    ),
    "person called robot": (
        lambda d: d["people"][1].update(name="robot"),
        (
            "people[1]: ",
            "'robot'",
        ),
    ),
    "two things of one name": (
        lambda d: d["things"][2].update(name="table_1"),
        (
            "things[2].name: 'table_1'",
            "things[0]",
        ),
    ),
    "waypoint in a wall": (
        lambda d: d["people"][0]["path"][0].update(at_m=[3.0, 3.05]),
        ("people[0].path[0].at_m: (3, 3.05)", "'wall_north'"),
    ),
    "waypoint in a thing": (
        lambda d: d["people"][0]["path"][0].update(at_m=[6.0, -1.5]),
        ("people[0].path[0].at_m: (6, -1.5)", "'table_1'"),
    ),
    "waypoint outside": (
        lambda d: d["people"][0]["path"][0].update(at_m=[30.0, 0.0]),
        ("people[0].path[0].at_m: (30, 0)", "x 0 to 8"),
    ),
    "way through a wall": (
        lambda d: d["people"][0]["path"][1].update(at_m=[3.5, 2.0]),
        ("people[0].path[2].at_m: ", "(3.5, 2)", "(5, 4)", "'wall_north'"),
    ),
    "way through a thing": (
        lambda d: d["people"][0].update(path=[{"at_m": [3.0, 1.0]}, {"at_m": [6.0, -2.7]}]),
        ("people[0].path[1].at_m: ", "(3, 1)", "(6, -2.7)", "'table_1'"),
    ),
    "the same point twice": (
        lambda d: d["people"][0]["path"].insert(1, {"at_m": [3.0, 1.0]}),
        ("people[0].path[1].at_m: ", "pause_s"),
    ),
    "robot in a thing": (
        lambda d: d["robot"].update(at_m=[6.0, -1.2]),
        ("robot.at_m: (6, -1.2)", "'table_1'"),
    ),
    "robot in a wall": (
        lambda d: d["robot"].update(at_m=[0.1, 0.0]),
        ("robot.at_m: (0.1, 0)", "'wall_west'"),
    ),
    "robot outside": (
        lambda d: d["robot"].update(at_m=[-5.0, 0.0]),
        (
            "robot.at_m: (-5, 0)",
            "x 0 to 8",
        ),
    ),
    "person in the robot": (
        lambda d: d["people"][1]["path"][0].update(at_m=[1.3, 0.0]),
        (
            "people[1].path[0].at_m: 'ben'",
            "0.3 m",
        ),
    ),
    "commands for a standing robot": (
        lambda d: d["robot"].update(commands=[{"from_s": 0.0}]),
        (
            "robot.commands: ",
            "'scripted'",
        ),
    ),
    "a time to give up for a standing robot": (
        lambda d: d["robot"].update(give_up_s=60.0),
        ("robot.give_up_s: ", "'follow_person'"),
    ),
    "commands out of order": (
        lambda d: d["robot"].update(behaviour="scripted", commands=[{"from_s": 2.0}, {"from_s": 1.0}]),
        (
            "robot.commands[1].from_s: 1 ",
            "2",
        ),
    ),
    "unknown behaviour": (
        lambda d: d["robot"].update(behaviour="folow_person"),
        ("robot.behaviour: ", "'folow_person'", "'follow_person'"),
    ),
    "lights out of order": (
        lambda d: d.update(lights=[{"at_s": 5.0, "level": 0.0}, {"at_s": 5.0, "level": 1.0}]),
        ("lights[1].at_s: 5 ",),
    ),
    "door beyond its wall": (
        lambda d: d["place"]["doors"][0].update(along_m=7.9),
        ("place.doors[0].along_m: 7.9 ", "'north'"),
    ),
    "door as high as the ceiling": (
        lambda d: d["place"]["doors"][0].update(height_m=2.7),
        ("place.doors[0].height_m: 2.7 ",),
    ),
    "thing without a place": (
        lambda d: d["things"][0].pop("at_m"),
        ("things[0]: ", "'at_m'", "'wall' and 'along_m'"),
    ),
    "thing outside": (
        lambda d: d["things"][2].update(at_m=[40.0, 0.0]),
        (
            "things[2].at_m: (40, 0)",
            "x 0 to 8",
        ),
    ),
    "thing with two places": (
        lambda d: d["things"][3].update(at_m=[1.0, 1.0]),
        (
            "things[3].wall: ",
            "'along_m'",
            "'at_m'",
        ),
    ),
    "group in a wall": (
        lambda d: d.update(groups=[{"names": ["x", "y"], "path": [{"at_m": [3, 2.5]}, {"at_m": [4, 2.1]}]}]),
        ("groups[0].path[0].at_m:", "'wall_north'"),
    ),
    "absolute URDF": (
        lambda d: d["things"].append({"kind": "urdf", "at_m": [4, 2], "urdf": "/etc/passwd"}),
        (
            "things[4].urdf: '/etc/passwd'",
            "pybullet_data",
        ),
    ),
    "URDF that climbs out": (
        lambda d: d["things"].append({"kind": "urdf", "at_m": [4, 2], "urdf": "../../secret.urdf"}),
        ("things[4].urdf: '../../secret.urdf'", "'..'"),
    ),
    "unknown URDF": (
        lambda d: d["things"].append({"kind": "urdf", "at_m": [4, 2], "urdf": "tabel.urdf"}),
        (
            "things[4].urdf: 'tabel.urdf'",
            "pybullet_data",
        ),
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_refused_with_file_key_and_what_would_be_right(mistake: str) -> None:
    change, expected = MISTAKES[mistake]
    data = copy.deepcopy(GOOD)
    change(data)
    message = refusal(data)
    assert_names(message, *expected)


def test_several_mistakes_come_on_one_line_the_misspelt_key_first() -> None:
    data = copy.deepcopy(GOOD)
    data["duration_s"] = -1.0
    data["robot"]["comands"] = []
    for person in data["people"]:
        person["height_m"] = 9.0
    message = refusal(data)
    misspelt, wrong = message.index("robot: "), message.index("duration_s: ")
    assert_names(message[misspelt:wrong], "'comands'", "'commands'")
    assert message.endswith("; and 1 more")


def test_a_person_may_sit_on_a_chair_but_not_stand_in_it() -> None:
    data = copy.deepcopy(GOOD)
    seat = {"at_m": [4.0, -2.0], "pause_s": 3.0, "posture": "sitting"}
    data["people"][1]["path"] = [{"at_m": [3.0, -1.0]}, seat, {"at_m": [3.0, -1.2]}]
    parse_scenario(data, source="my.yaml", folder=Path("/nowhere"))
    seat["posture"] = "standing"
    assert "'chair_1'" in refusal(data)


def test_a_urdf_of_the_scenario_s_own_folder_is_found(tmp_path: Path) -> None:
    (tmp_path / "box.urdf").write_text(
        '<robot name="box"><link name="base"><visual><geometry><box size="0.4 0.4 0.4"/></geometry></visual>'
        "</link></robot>"
    )
    data = copy.deepcopy(GOOD)
    data["things"].append({"kind": "urdf", "at_m": [4.0, 2.0], "urdf": "box.urdf", "name": "crate"})
    place = parse_scenario(data, source="my.yaml", folder=tmp_path).place
    crate = place.obstacles[place.obstacle_names.index("crate")]
    assert crate == pytest.approx([3.8, 1.8, 4.2, 2.2])


def test_a_urdf_that_reads_a_mesh_elsewhere_is_refused(tmp_path: Path) -> None:
    (tmp_path / "spy.urdf").write_text(
        '<robot name="spy"><link name="base"><visual><geometry><mesh filename="../../key.obj"/></geometry>'
        "</visual></link></robot>"
    )
    data = copy.deepcopy(GOOD)
    data["things"].append({"kind": "urdf", "at_m": [4.0, 2.0], "urdf": "spy.urdf"})
    assert_names(refusal(data, tmp_path), "things[4].urdf: ", "spy.urdf", "key.obj")


def test_a_link_that_leads_out_of_the_folder_is_refused(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (tmp_path / "far.urdf").write_text("<robot/>")
    (home / "near.urdf").symlink_to(tmp_path / "far.urdf")
    data = copy.deepcopy(GOOD)
    data["things"].append({"kind": "urdf", "at_m": [4.0, 2.0], "urdf": "near.urdf"})
    assert_names(refusal(data, home), "things[4].urdf: 'near.urdf'", "pybullet_data")


def test_an_unknown_library_name_gets_a_hint() -> None:
    with refused("'pas_behind'", "'pass_behind'"):
        load_scenario("pas_behind")


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.floats(),
    st.integers(-(10**400), 10**400),
    st.text(max_size=5),
    st.lists(st.one_of(st.none(), st.floats(), st.text(max_size=3)), max_size=3),
    st.dictionaries(st.one_of(st.integers(), st.text(max_size=3)), st.none(), max_size=2),
)


def outcome(data: Data) -> str | None:
    """What the refusal says; None if the data are read."""
    try:
        parse_scenario(data, source="my.yaml", folder=Path("/nowhere")).world(0)
    except BadInput as error:
        return str(error)
    return None


def places(data: Any) -> list[tuple[Any, Any]]:
    """Every container of the data with every key or index in it."""
    pairs = list(data.items() if isinstance(data, dict) else enumerate(data))
    below = [pair for _, value in pairs if isinstance(value, dict | list) for pair in places(value)]
    return [(data, key) for key, _ in pairs] + below


@given(st.data())
@settings(max_examples=300, deadline=None)
def test_junk_anywhere_is_read_or_refused_on_one_line(random: st.DataObject) -> None:
    data = copy.deepcopy(GOOD)
    container, key = random.draw(st.sampled_from(places(data)))
    container[key] = random.draw(JUNK)
    message = outcome(data)
    assert message is None or (message.startswith("my.yaml: ") and "\n" not in message)


def test_all_faults_of_paths_are_said_at_once_each_on_a_line_of_its_own() -> None:
    data = copy.deepcopy(GOOD)
    data["people"][0]["path"][2]["at_m"] = [50.0, 4.0]
    data["people"][1]["path"] = [{"at_m": [1.0, 0.0]}, {"at_m": [6.0, -1.5]}, {"at_m": [3.0, 2.0]}]
    with pytest.raises(BadInput) as caught:
        parse_scenario(data, source="my.yaml", folder=Path("/nowhere"))
    lines = str(caught.value).splitlines()
    assert [line.split(": ")[:2] for line in lines] == [
        ["my.yaml", "people[0].path[2].at_m"],
        ["my.yaml", "people[1].path[1].at_m"],
        ["my.yaml", "people[1].path[0].at_m"],
    ]
    assert "outside the floor" in lines[0]
    assert "'table_1'" in lines[1]
    assert "inside the robot" in lines[2]
