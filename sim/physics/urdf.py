"""Model files: location of PyBullet's models, and shapes, links, joints and masses of URDFs."""

import importlib.util
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.shapes.shapes import Quaternion, Shape, ShapeKind, Vector
from peopleboy.user_files import read_text

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

MISSING = "PyBullet is not installed: there are wheels for Python 3.11 to 3.13 on Linux, macOS and Windows"
"""Message if PyBullet or its models are needed but not installed."""

MISSING_PHYSICS = f"{MISSING}; install it, or choose physics kinematic, which does not need it"
"""Message if PyBullet is needed to move the robot but not installed."""


def data_folder() -> Path:
    """Return the folder of pybullet_data.

    Raises:
        BadInput: PyBullet is not installed.
    """
    folder = _data_folder()
    if folder is None:
        raise BadInput(MISSING)
    return folder


def is_in_data(path: Path | str) -> bool:
    """Return whether a file, by name or full path, belongs to pybullet_data."""
    folder = _data_folder()
    return folder is not None and (folder / path).is_file() and (folder / path).is_relative_to(folder)


def _data_folder() -> Path | None:
    spec = importlib.util.find_spec("pybullet_data")
    return None if spec is None or spec.origin is None else Path(spec.origin).parent


def find_model(path: Path | str) -> Path:
    """Find a URDF or SDF file: by its path, else in pybullet_data.

    Raises:
        BadInput: the file does not exist, or PyBullet is not installed.
    """
    if Path(path).is_file():
        return Path(path).resolve()
    candidate = data_folder() / path
    if candidate.is_file():
        return candidate.resolve()
    raise BadInput(f"model file {path}: not found, neither as a path nor in pybullet_data")


# Where PyBullet searches for files named in a URDF, relative to the URDF's folder.
MESH_PLACES = (".", "..", "../..")
_PACKAGE = re.compile(r"(?:package|model)://")
_FILE = re.compile(r"file://(?:localhost(?=/))?")
_PACKAGES_UP = 8  # folders above a URDF in which its packages are searched for
_GREY = (0.5, 0.5, 0.5)
_DEEPEST = 200  # links in a chain: the pose of a link is that of its parent and more
# Keywords for materials in OBJ files, and for textures in material files; the name is the line's last word.
_NAMED = {".obj": r"^mtllib\s+(?:.*\s)?(\S+)\s*$", ".mtl": r"^(?:map_\w+|bump)\s+(?:.*\s)?(\S+)\s*$"}

Numbers = NDArray[np.float64]
LinkPose = tuple[Numbers, "Rotation"]
Joints = dict[str, ElementTree.Element]  # by child link


@dataclass(frozen=True, slots=True)
class UrdfShape:
    """One visible shape of a URDF.

    Attributes:
        shape: shape and pose in the root link's frame with all joints at zero.
        rgb: red, green, blue in 0..1 from the file; grey by default.
    """

    shape: Shape
    rgb: tuple[float, float, float]


def find_urdf(name: str) -> Path:
    """Find a URDF like PyBullet: an absolute path, or a name in pybullet_data.

    Raises:
        BadInput: it is a name, and PyBullet is not installed.
    """
    return Path(name) if Path(name).is_absolute() else data_folder() / name


@cache
def read_urdf(path: Path) -> tuple[UrdfShape, ...]:
    """Read the visible shapes of all links, in the order of the file.

    Raises:
        BadInput: the file is not a URDF, or has an invalid shape or number.
    """
    root = parse_urdf(path)
    joints = _read_joints(root, path)
    colours = {m.get("name", ""): _rgb(m) for m in root.iterfind("./material") if m.find("color") is not None}
    try:
        return tuple(
            _read_visual(visual, link_pose(link.get("name", ""), joints), colours, path)
            for link in root.iterfind("./link")
            for visual in link.findall("./visual") or link.findall("./collision")  # like PyBullet
        )
    except (KeyError, ValueError) as error:
        raise BadInput(f"{path} cannot be read as a URDF: {error}") from error


def mesh_files(path: Path) -> Iterator[str]:
    """Yield the mesh files of a URDF, as written there.

    Raises:
        BadInput: the file is not XML.
    """
    for mesh in parse_urdf(path).iter("mesh"):
        yield mesh.get("filename", "")


def files_of(urdf: Path) -> Iterator[Path]:
    """Yield a URDF and all files that it needs: meshes, their materials and textures."""
    yield urdf
    for part in parse_urdf(urdf).iter():
        name = part.get("filename", "")
        for path in [path for path in _places_of(urdf, name) if name and path.is_file()][:1]:
            yield path
            yield from _named_by(path)


def _named_by(path: Path) -> Iterator[Path]:
    """Yield the files that a mesh or a material refers to."""
    pattern = _NAMED.get(path.suffix.lower())
    if pattern is None:
        return
    for name in re.findall(pattern, path.read_text("utf-8", errors="replace"), re.MULTILINE):
        other = path.parent / name
        if other.is_file():
            yield other
            yield from _named_by(other)


def parse_urdf(path: Path) -> ElementTree.Element:
    """Read a file as XML.

    Raises:
        BadInput: it cannot be read, or is not XML.
    """
    try:
        # A declaration may claim an encoding that is not the file's.
        root = ElementTree.fromstring(re.sub(r"<\?xml.*?\?>", "", _text_of(path), count=1))
        if _is_xacro(root):
            raise BadInput(
                f"{path} cannot be read as a URDF: it is a xacro that is not expanded; "
                f"give the output of `xacro {path.name}`"
            )
        return root
    except (OSError, UnicodeDecodeError, ElementTree.ParseError) as error:
        raise BadInput(f"{path} cannot be read as a URDF: {error}") from error


def _text_of(path: Path) -> str:
    """Read a file in UTF-8, or in Latin-1 as old tools write it."""
    try:
        return read_text(path)
    except UnicodeDecodeError:
        return read_text(path, "latin-1")


def _is_xacro(root: ElementTree.Element) -> bool:
    """Return whether a file has macros, or numbers in braces, that have not been expanded."""
    return any(
        "xacro" in part.tag.partition("}")[0] or any("${" in value for value in part.attrib.values())
        for part in root.iter()
        if isinstance(part.tag, str)
    )


def _read_joints(root: ElementTree.Element, path: Path) -> Joints:
    """Read the joints by child link, which must form trees."""
    joints = {link_named(joint, "child"): joint for joint in root.iterfind("./joint")}
    depths: dict[str, int] = {}
    for child in joints:
        chain = [child]
        while (parent := link_named(joints[chain[-1]], "parent")) in joints and parent not in depths:
            if parent in chain:
                ring = ", ".join(chain[chain.index(parent) :][:4])
                raise BadInput(f"{path} cannot be read as a URDF: links hang on each other in a ring: {ring}")
            chain.append(parent)
            if len(chain) > _DEEPEST:
                break
        depth = depths.get(parent, 0)
        depths.update({link: depth + above for above, link in enumerate(reversed(chain), start=1)})
        if depths[child] > _DEEPEST:
            raise BadInput(f"{path} cannot be read as a URDF: more than {_DEEPEST} links in a chain")
    return joints


def link_pose(link: str, joints: Joints) -> LinkPose:
    """Return position and rotation of a link in the root link's frame."""
    if link not in joints:
        return _root_pose()
    position, turn = link_pose(link_named(joints[link], "parent"), joints)
    offset, rotation = _origin(joints[link])
    return position + turn.apply(offset), turn * rotation


def _read_visual(
    visual: ElementTree.Element,
    link: LinkPose,
    colours: dict[str, tuple[float, float, float]],
    path: Path,
) -> UrdfShape:
    material = visual.find("material")
    shape = read_shape(visual, link, path)
    if material is None:
        return UrdfShape(shape, _GREY)
    named = colours.get(material.get("name", ""), _GREY)
    return UrdfShape(shape, _rgb(material) if material.find("color") is not None else named)


def read_shape(element: ElementTree.Element, link: LinkPose, path: Path) -> Shape:
    """Read a visual or collision element of a link with a given position and rotation."""
    offset, rotation = _origin(element)
    kind, size, mesh = _read_geometry(element, path)
    return Shape(
        kind=kind,
        size=size,
        position=_vector(link[0] + link[1].apply(offset)),
        orientation=_quaternion(link[1] * rotation),
        mesh=mesh,
    )


def _read_geometry(visual: ElementTree.Element, path: Path) -> tuple[ShapeKind, Vector, Path | None]:
    geometry = visual.find("./geometry/*")
    if geometry is None:
        raise ValueError("a visual without a geometry")
    tag = geometry.tag
    if tag == "mesh":
        return ShapeKind.MESH, _scale(geometry), _find_mesh(path, geometry.get("filename", ""))
    if tag == "box":
        return ShapeKind.BOX, _vector(_lengths(geometry, "size")), None
    if tag == "sphere":
        return ShapeKind.SPHERE, (float(_lengths(geometry, "radius")[0]), 0.0, 0.0), None
    if tag == "plane":
        return ShapeKind.PLANE, (0.0, 0.0, 0.0), None
    kind = {"cylinder": ShapeKind.CYLINDER, "capsule": ShapeKind.CAPSULE}[tag]
    length, radius = (float(_lengths(geometry, key)[0]) for key in ("length", "radius"))
    return kind, (length, radius, 0.0), None


def _lengths(geometry: ElementTree.Element, key: str) -> Numbers:
    """Read lengths, which must be positive."""
    lengths = read_numbers(geometry.attrib[key])
    if not len(lengths) or not (lengths > 0.0).all():
        raise ValueError(f"{geometry.tag}: {key} must be positive, got {geometry.attrib[key][:40]!r}")
    return lengths


def _scale(mesh: ElementTree.Element) -> Vector:
    factors = read_numbers(mesh.get("scale", "1 1 1"))
    return _vector(np.broadcast_to(factors, 3) if len(factors) == 1 else factors)


def _find_mesh(urdf: Path, name: str) -> Path:
    found = [place.resolve() for place in _places_of(urdf, name) if place.is_file()]
    if not found:
        raise ValueError(f"mesh {name[:80]!r} not found")
    return found[0]


def _places_of(urdf: Path, name: str) -> list[Path]:
    """Return where a file that a URDF names may be: like PyBullet, and in a package around the URDF."""
    if _FILE.match(name):
        name = unquote(_FILE.sub("", name, count=1))
    plain = _PACKAGE.sub("", name.replace("\\", "/"), count=1)
    places = [urdf.parent / place / plain for place in MESH_PLACES]
    if _PACKAGE.match(name):
        places += [folder / plain for folder in list(urdf.parents)[:_PACKAGES_UP]]
    return places


def _origin(element: ElementTree.Element) -> LinkPose:
    from scipy.spatial.transform import Rotation  # here, as it is slow to import

    origin = element.find("origin")
    if origin is None:
        return _root_pose()
    turn = Rotation.from_euler("xyz", read_numbers(origin.get("rpy", "0 0 0"))[:3])
    return read_numbers(origin.get("xyz", "0 0 0"))[:3], turn


def link_named(joint: ElementTree.Element, tag: str) -> str:
    """Return the name of the parent or child link of a joint."""
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _rgb(material: ElementTree.Element) -> tuple[float, float, float]:
    colour = material.find("color")
    return _vector(read_numbers("0.5 0.5 0.5" if colour is None else colour.get("rgba", "")))


def read_numbers(text: str) -> Numbers:
    """Read finite numbers like PyBullet, which accepts commas for spaces."""
    numbers = np.array([float(word) for word in text.replace(",", " ").split()])
    if not np.isfinite(numbers).all():
        raise ValueError(f"numbers must be finite, got {text[:40]!r}")
    return numbers


def _vector(numbers: Numbers) -> Vector:
    x, y, z = (float(number) for number in numbers[:3])
    return x, y, z


def _quaternion(rotation: "Rotation") -> Quaternion:
    x, y, z, w = (float(number) for number in rotation.as_quat())
    return x, y, z, w


def _root_pose() -> LinkPose:
    """Return the pose of the root link in its own frame."""
    from scipy.spatial.transform import Rotation  # here, as it is slow to import

    return np.zeros(3), Rotation.identity()


@dataclass(frozen=True, slots=True, eq=False)
class UrdfLink:
    """One link with all joints at zero.

    Attributes:
        name: name of the link.
        joint: name of its parent joint; empty for the root.
        turns: whether that joint is continuous, like a wheel's.
        base_from_link: (4, 4) pose in the root link's frame.
        visible, solid: visual and collision shapes, in the link's frame.
        mass_kg: [kg].
        centre_m: (3,) [m] centre of mass, in the link's frame.
        inertia_kg_m2: [kg m2] moment of inertia about the vertical axis through that centre.
    """

    name: str
    joint: str
    turns: bool
    base_from_link: Matrix
    visible: tuple[Shape, ...]
    solid: tuple[Shape, ...]
    mass_kg: float
    centre_m: Matrix
    inertia_kg_m2: float


def read_links(path: Path, scale: float = 1.0) -> tuple[UrdfLink, ...]:
    """Read all links, parents before children, with all lengths scaled by a factor.

    Raises:
        BadInput: the file is not a URDF, or has an invalid shape or number.
    """
    return tuple(_scaled(link, scale) for link in _read_links(path))


@cache
def _read_links(path: Path) -> tuple[UrdfLink, ...]:
    root = parse_urdf(path)
    joints = _read_joints(root, path)
    links = {link.get("name", ""): link for link in root.iterfind("./link")}
    try:
        first = next((name for name in links if name not in joints), None)
        if first is None:
            raise ValueError("no link is the root")
        return tuple(_read_link(links[name], joints, path) for name in _in_order(first, joints))
    except (KeyError, ValueError) as error:
        raise BadInput(f"{path} cannot be read as a URDF: {error}") from error


def _in_order(name: str, joints: Joints) -> list[str]:
    children = [child for child, joint in joints.items() if link_named(joint, "parent") == name]
    return [name, *(below for child in children for below in _in_order(child, joints))]


def _read_link(link: ElementTree.Element, joints: Joints, path: Path) -> UrdfLink:
    name = link.get("name", "")
    joint = joints.get(name)
    position, rotation = link_pose(name, joints)
    base_from_link = np.eye(4)
    base_from_link[:3, :3], base_from_link[:3, 3] = rotation.as_matrix(), position
    solid = link.findall("./collision")
    centre = link.find("./inertial/origin")
    return UrdfLink(
        name=name,
        joint="" if joint is None else joint.get("name", ""),
        turns=joint is not None and joint.get("type") == "continuous",
        base_from_link=base_from_link,
        visible=tuple(read_shape(each, _root_pose(), path) for each in link.findall("./visual") or solid),
        solid=tuple(read_shape(each, _root_pose(), path) for each in solid),
        mass_kg=_number(link, "./inertial/mass", "value"),
        centre_m=np.zeros(3) if centre is None else read_numbers(centre.get("xyz", "0 0 0")),
        inertia_kg_m2=_number(link, "./inertial/inertia", "izz"),
    )


def _number(link: ElementTree.Element, where: str, key: str) -> float:
    found = link.find(where)
    return 0.0 if found is None else float(found.get(key, "0"))


def _scaled(link: UrdfLink, scale: float) -> UrdfLink:
    if scale == 1.0:
        return link
    pose = link.base_from_link.copy()
    pose[:3, 3] *= scale
    return replace(
        link,
        base_from_link=pose,
        visible=tuple(_scaled_shape(shape, scale) for shape in link.visible),
        solid=tuple(_scaled_shape(shape, scale) for shape in link.solid),
        centre_m=scale * link.centre_m,
    )


def _scaled_shape(shape: Shape, scale: float) -> Shape:
    a, b, c = shape.size
    x, y, z = shape.position
    return replace(shape, size=(scale * a, scale * b, scale * c), position=(scale * x, scale * y, scale * z))
