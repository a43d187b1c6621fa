# SPDX-License-Identifier: GPL-2.0-or-later
"""Attacks on attributes, methods and O.engines. All that an attack does follows from its name."""

import re
from functools import lru_cache
from random import Random

import numpy as np
from arsenal import CLASSES, OF_BODIES, attributes, is_senseless, methods, values
from membrane import scene
from situations import SITUATIONS
from support import O
from yade import wrapper as yade

STEPS = 12  # after an attack
TURNS = 20  # of an attack on a scene that runs meanwhile
UNCLEAR = re.compile(r"std::|_M_|basic_string|bad_alloc|bad_cast|unidentifiable|NULL")
ENDLESS = 100  # steps that nobody has the time for


class Harm(AssertionError):
    """What an attack has done and nobody told."""


def names(times):
    """Names of attacks: `times` on each attribute and method, more on the list of engines."""
    targets = [
        f"{name}.{member}"
        for name, cls in CLASSES.items()
        for member in (*attributes(cls), *methods(cls))
    ]
    for target in targets:
        yield from (f"{target} {number}" for number in range(times))
    for target in ("O.engines", "O.bodies"):
        yield from (f"{target} {number}" for number in range(10 * times))


def carry_out(name, tell):
    """Carry out the attack of a name; `tell` is called with what comes next.

    Raises
    ------
    Harm
        If nothing was refused, or not in a sentence, and the run did not go on as it should.
    """
    chance = Random(name)
    enter, path = chance.choice(SITUATIONS), chance.choice(scene.PATHS)
    tell(f"{name}: {enter.__name__}({path})")
    world = enter(path)
    target, member = name.split()[0].split(".")
    if target == "O":
        attack = {"engines": attack_engines, "bodies": attack_a_body}[member]
    else:
        attack = attack_attribute if member in attributes(CLASSES[target]) else attack_method
    value, refused = attack(world, target, member, chance, tell)
    stopped = go_on(world)
    if not world.running and (refused or is_senseless(value) and not stopped):
        if not np.array_equal(positions(), undisturbed(enter, path)):
            raise Harm(f"the run is another one ({refused!r})")
    follow_up(world)


def attempt(action):
    """The exception that an action ends with, which must be a sentence; or None."""
    try:
        action()
    except Exception as error:
        # Of an argument's type Boost.Python tells in its own words.
        if not isinstance(error, TypeError) and UNCLEAR.search(f"{error}"):
            raise Harm(f"no sentence: {error!r}") from error
        return error


def positions():
    """Positions (B, 3) [m] of the scene's bodies."""
    return np.array([body.state.pos for body in O.bodies])


def give_engines(engines):
    """Let the scene run these."""
    O.engines = engines


def go_on(world, steps=STEPS):
    """Run on; gives what stopped the run, or None. It has to be stopped where numbers are lost."""
    if not O.engines:
        attempt(lambda: give_engines(world.engines))
    stopped = attempt(O.wait if world.running else lambda: scene.advance(steps))
    if not (stopped or np.all(np.isfinite(positions()))):  # lost in the last step, it may be
        stopped = attempt(lambda: scene.advance(1))
        if not stopped:
            raise Harm("numbers are no longer finite, and nobody says so")
    return stopped


def follow_up(world):
    """Ask everything; then run on, and once more after saving and loading."""
    for one in world.objects.values():
        ask(one)
    world.running = False
    go_on(world, 3)
    bodies = len(O.bodies)
    if any(max(link.id1, link.id2) >= bodies for link in O.interactions):
        O.interactions.clear()  # YADE itself dies when it loads them
    if not attempt(lambda: O.save(":memory:attacked", quiet=True)):
        O.reset()
        if not attempt(lambda: O.load(":memory:attacked", quiet=True)):
            go_on(world, 3)


def ask(one):
    """Ask an object for everything that needs no argument."""
    for name in (name for name in dir(type(one)) if not name.startswith("__")):
        answer = []
        if not attempt(lambda: answer.append(getattr(one, name))) and callable(answer[0]):
            attempt(answer[0])
    attempt(lambda: str(one))
    if isinstance(one, yade.Engine):
        attempt(one)


@lru_cache(maxsize=None)
def undisturbed(enter, path):
    """Positions after STEPS without an attack."""
    go_on(enter(path))
    return positions()


def brief(value):
    """A value in few words."""
    text = repr(value)
    return text if len(text) < 200 else f"{text[:150]} … ({len(text)} characters)"


# How an attribute can be set.


def set_it(world, name, member, value):
    setattr(world.objects[name], member, value)


def update(world, name, member, value):
    world.objects[name].updateAttrs({member: value})


def update_by_half(world, name, member, value):
    """What comes after it is refused, so that nothing follows from it."""
    one = world.objects[name]
    other = next(iter(attributes(type(one))))
    one.updateAttrs({member: value, other: object()})


def put_new(world, name, member, value):
    """A new object in the place of the old one."""
    old = world.objects[name]
    new = type(old)(**{**old.dict(), member: value})
    attempt(lambda: put(world, old, new))


def put(world, old, new):
    """Let everything in the scene that points to `old` point to `new`."""
    world.objects[type(old).__name__] = new
    world.engines = [new if one == old else one for one in world.engines]
    O.engines = [new if one == old else one for one in O.engines]
    holders = [(one, ("shape", "mat")) for one in O.bodies]
    holders += [(one, ("geom", "phys")) for one in O.interactions]
    holders += [(one, one.dict()) for one in world.objects.values()]
    for holder, places in holders:
        for place in places:
            there = getattr(holder, place)
            if isinstance(there, type(old)) and there == old:
                attempt(lambda: setattr(holder, place, new))


def attack_attribute(world, name, member, chance, tell):
    """Set an attribute to something; gives the value, or None, and what refused it."""
    one = world.objects[name]
    present = getattr(one, member, None)
    kind = attributes(type(one))[member]
    value = chance.choice(values(kind, present, list(world.objects.values())))
    how = chance.choice((set_it, update, update_by_half, put_new))
    tell(f"{how.__name__}({brief(value)})")
    refused = None
    for _ in range(TURNS if world.running else 1):
        refused = attempt(lambda: how(world, name, member, value))
        if world.running and present is not None:
            attempt(lambda: update(world, name, member, present))
    return None if how is put_new else value, refused  # a new one need not do as the old one


def attack_method(world, name, member, chance, tell):
    """Call a method with something; gives the arguments and the exception, or None."""
    some = [value for kind in ("Real", "int", "vector<Vector3r>") for value in values(kind, [], [])]
    arguments = chance.choices(some, k=chance.choice((0, 1, 1, 1, 2, 3)))
    if member == "advance":
        arguments = [one for one in arguments if not (isinstance(one, int) and one > ENDLESS)]
    tell(f"call{brief(arguments)}")
    call = getattr(world.objects[name], member)
    for _ in range(TURNS if world.running else 1):
        refused = attempt(lambda: call(*arguments))
    return arguments, refused


def attack_engines(world, _, __, chance, tell):
    """Leave engines out, have them twice, elsewhere, dead, or new ones."""
    engines = list(world.engines)
    new = [one for one in world.objects.values() if isinstance(one, yade.Engine)]
    for _ in range(chance.choice((1, 1, 2, 4))):
        here, there = (chance.randrange(len(engines)) for _ in range(2))
        change = chance.choice(("drop", "double", "swap", "kill", "add"))
        tell(f"{change} {type(engines[here]).__name__} {there}")
        if change == "drop" and len(engines) > 1:
            del engines[here]
        elif change == "double":
            engines.insert(there, engines[here])
        elif change == "swap":
            engines[here], engines[there] = engines[there], engines[here]
        elif change == "kill":
            engines[here].dead = not engines[here].dead
        elif change == "add":
            engines.insert(there, chance.choice(new))
    return None, attempt(lambda: give_engines(engines))


def attack_a_body(world, _, __, chance, tell):
    """Change something of a body, or take it away."""
    if not len(O.bodies):
        return None, None
    body = chance.choice(list(O.bodies))
    place, kind = chance.choice([*OF_BODIES.items(), ("erase", "")])
    tell(f"{place} of #{body.id}")
    if place == "erase":
        return None, attempt(lambda: O.bodies.erase(body.id))
    if kind == "another":
        value = type(getattr(body, place))()
    else:
        value = chance.choice(values(kind, None, list(world.objects.values())))
    tell(brief(value))
    holder, _, member = place.rpartition(".")
    return None, attempt(lambda: setattr(body.state if holder else body, member, value))
