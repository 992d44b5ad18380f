"""Program that reports what a screen reader sees on the desktop; run by Debian's Python, which has AT-SPI's packages.

For each line `look` on standard input, it prints one line of JSON: all accessible objects that are visible.

All requests about the objects of one depth are sent at once, and a program answers all of them in one turn. Screen
readers send one request after the other; on a busy machine, each of these some hundred requests waits for its turn.
Their answers would then describe different moments, and miss most changes.
"""

import json
import sys
import time

from gi.repository import Atspi, Gio, GLib

PATIENCE = 10.0
"""Seconds for which a look is repeated if objects vanish during it."""
TIMEOUT = 60_000
"""Milliseconds that a program may take for an answer."""

DESKTOP = ("org.a11y.atspi.Registry", "/org/a11y/atspi/accessible/root")
NOBODY = "/org/a11y/atspi/null"
ACCESSIBLE, COMPONENT, TEXT = (f"org.a11y.atspi.{name}" for name in ("Accessible", "Component", "Text"))
PROPERTIES = "org.freedesktop.DBus.Properties"
LONGEST = 5000
"""Number of characters of a text that are read."""


def bus():
    """Return a connection to the accessibility bus, on which programs describe what they show."""
    session = Gio.bus_get_sync(Gio.BusType.SESSION)
    asked = ("org.a11y.Bus", "/org/a11y/bus", "org.a11y.Bus", "GetAddress", None, None)
    (address,) = session.call_sync(*asked, Gio.DBusCallFlags.NONE, TIMEOUT, None).unpack()
    kind = Gio.DBusConnectionFlags.AUTHENTICATION_CLIENT | Gio.DBusConnectionFlags.MESSAGE_BUS_CONNECTION
    return Gio.DBusConnection.new_for_address_sync(address, kind)


def together(connection, questions):
    """Send all requests at once; return their answers. A request has an object, an interface, a method and arguments.

    Raises:
        GLib.Error: one of the objects does not exist any more.
    """
    answers = [None] * len(questions)
    loop, left, failed = GLib.MainLoop(), len(questions), []

    def take(_, result, number):
        nonlocal left
        try:
            answers[number] = connection.call_finish(result).unpack()
        except GLib.Error as error:
            failed.append(error)
        left -= 1
        if not left:
            loop.quit()

    for number, ((name, path), interface, method, arguments) in enumerate(questions):
        asked = (name, path, interface, method, arguments, None, Gio.DBusCallFlags.NONE, TIMEOUT, None)
        connection.call(*asked, take, number)
    if questions:
        loop.run()
    if failed:
        raise failed[0]
    return answers


def owned(interface, name):
    """Return the request for a property."""
    return PROPERTIES, "Get", GLib.Variant("(ss)", (interface, name))


def level(connection, places, kinds):
    """Return the properties of objects, and the addresses of their children.

    Args:
        connection: connection to the bus.
        places: addresses of the objects of one depth.
        kinds: interfaces and role of each address, which never change.
    """
    new = [place for place in places if place not in kinds]
    of_new = [(ACCESSIBLE, "GetInterfaces", None), (ACCESSIBLE, "GetRole", None)]
    of_all = [
        (ACCESSIBLE, "GetState", None), (ACCESSIBLE, "GetChildren", None), owned(ACCESSIBLE, "Name"),
        owned(ACCESSIBLE, "Description"),
    ]  # fmt: skip
    asked = [(place, *question) for place in new for question in of_new]
    asked += [(place, *question) for place in places for question in of_all]
    told = iter(together(connection, asked))
    for place in new:
        (interfaces,), (role,) = (next(told) for _ in of_new)
        kinds[place] = interfaces, Atspi.role_get_name(Atspi.Role(role))
    known, inside = [], []
    for place in places:
        (states,), (children,), (name,), (description,) = (next(told) for _ in of_all)
        bits = states[0] | states[1] << 32
        interfaces, kind = kinds[place]
        known.append({"interfaces": interfaces, "bits": bits, "role": kind, "name": name, "description": description})
        # A hidden object has no visible children. A program itself is neither visible nor hidden.
        is_open = kind == "application" or bits >> int(Atspi.StateType.SHOWING) & 1
        inside.append([tuple(child) for child in children if is_open and child[1] != NOBODY])
    boxed = [(place, one) for place, one in zip(places, known, strict=True) if COMPONENT in one["interfaces"]]
    whole = GLib.Variant("(u)", (Atspi.CoordType.SCREEN,))
    boxes = together(connection, [(place, COMPONENT, "GetExtents", whole) for place, _ in boxed])
    for (_, one), (box,) in zip(boxed, boxes, strict=True):
        one["box"] = box
    written = [(place, one) for place, one in boxed if TEXT in one["interfaces"]]
    counts = together(connection, [(place, *owned(TEXT, "CharacterCount")) for place, _ in written])
    spans = [GLib.Variant("(ii)", (0, min(count, LONGEST))) for (count,) in counts]
    texts = together(
        connection, [(place, TEXT, "GetText", span) for (place, _), span in zip(written, spans, strict=True)]
    )
    for (_, one), (text,) in zip(written, texts, strict=True):
        one["text"] = text
    return known, inside


def tree(connection, kinds):
    """Return all objects as a tree, each with its children."""
    ((applications,),) = together(connection, [(DESKTOP, ACCESSIBLE, "GetChildren", None)])
    root = {"inside": []}
    places, parents = [tuple(place) for place in applications], [root] * len(applications)
    while places:
        known, inside = level(connection, places, kinds)
        for one, parent in zip(known, parents, strict=True):
            one["inside"] = []
            parent["inside"].append(one)
        parents = [one for one, children in zip(known, inside, strict=True) for _ in children]
        places = [child for children in inside for child in children]
    return root["inside"]


def seen(things, window=""):
    """Yield the visible objects of a tree, parents before children."""
    for one in things:
        is_in = {name: bool(one["bits"] >> int(getattr(Atspi.StateType, name.upper())) & 1) for name in STATES}
        within = one["name"] if one["role"] in ("frame", "window", "dialog") else window
        if "box" in one and is_in.pop("showing"):
            x, y, width, height = one["box"]
            place = {"x": x, "y": y, "width": width, "height": height}
            words = {name: one.get(name, "") for name in ("name", "description", "role", "text")}
            yield {"window": within, **words, **place, **is_in}
        yield from seen(one["inside"], within)


STATES = ("showing", "enabled", "focusable", "focused", "checked")


def look(connection, kinds):
    """Return all visible objects; repeat the look if an object vanished during it."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return list(seen(tree(connection, kinds)))
        except GLib.Error as error:
            if time.monotonic() > end:
                raise
            print(error.message, file=sys.stderr)
            time.sleep(0.02)


def main():
    connection, kinds = bus(), {}
    for _ in sys.stdin:
        print(json.dumps(look(connection, kinds)), flush=True)


main()
