"""Registrations of publishers, subscribers, services and parameters: the master's view of the graph.

Source: ROS's rosmaster/registrations.py.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from thbridge.rosgraph.wire.arguments import InvalidArgumentError
from thbridge.rosgraph.wire.xmlrpc import XmlRpcValue

MAX_NODES = 2048
"""Maximum number of nodes. Each node may need a socket here, because the master notifies nodes of changes of topics."""

MAX_REGISTRATIONS = 32_768
"""Maximum number of registrations. A graph of 1000 nodes and 5000 topics has about 20,000 registrations."""


class ProviderKind(Enum):
    """Kind of a registration with the master."""

    PUBLISHER = "publisher"
    SUBSCRIBER = "subscriber"
    SERVICE = "service"
    PARAMETER = "parameter"


@dataclass(frozen=True, slots=True)
class Provider:
    """Node registered for a topic, a service or a parameter.

    Args:
        node: name of the node (its caller id).
        api: URI of its slave API, or of the service.
    """

    node: str
    api: str


@dataclass(slots=True)
class _Node:
    """Node with at least one registration."""

    api: str
    registered: set[tuple[ProviderKind, str]] = field(default_factory=set)


class Registrations:
    """Registrations of all nodes.

    A service has one provider, which is the last registered node. Topics and parameters have any number of providers.
    Topics keep the order of their first registrations.
    """

    def __init__(self) -> None:
        self._nodes: dict[str, _Node] = {}
        self._count = 0
        # The keys of the inner dicts are ordered sets of providers, because a topic may have thousands of providers.
        self._providers: dict[ProviderKind, dict[str, dict[Provider, None]]] = {kind: {} for kind in ProviderKind}

    def keys(self, kind: ProviderKind) -> list[str]:
        """Return the topics, services or parameters with a registration."""
        return [*self._providers[kind]]

    def is_topic(self, name: str) -> bool:
        """Return True for a topic with a publisher or a subscriber."""
        return any(name in self._providers[kind] for kind in (ProviderKind.PUBLISHER, ProviderKind.SUBSCRIBER))

    def providers(self, kind: ProviderKind, key: str) -> tuple[Provider, ...]:
        """Return the registered nodes, in the order of registration."""
        return tuple(self._providers[kind].get(key, ()))

    def apis(self, kind: ProviderKind, key: str) -> list[str]:
        """Return the URIs of the registered nodes, in the order of registration."""
        return [provider.api for provider in self.providers(kind, key)]

    def api_of(self, node: str) -> str | None:
        """Return the URI of a node's slave API, or None if the node has no registration."""
        known = self._nodes.get(node)
        return None if known is None else known.api

    def state(self, kind: ProviderKind) -> list[XmlRpcValue]:
        """Return pairs of a key and the names of its registered nodes."""
        return [[key, [provider.node for provider in providers]] for key, providers in self._providers[kind].items()]

    def register(self, kind: ProviderKind, key: str, node: str, node_api: str, api: str | None = None) -> str | None:
        """Register a node.

        Args:
            kind: kind of the registration.
            key: the topic, service or parameter.
            node: the node's name.
            node_api: URI of its slave API.
            api: URI of the service itself. None for other kinds.

        Returns:
            The slave API of another node of the same name. This node replaces it, and all its registrations are
            removed. None if there is no other node of the same name.

        Raises:
            InvalidArgumentError: there are already too many nodes or registrations.
        """
        known = self._nodes.get(node)
        if known is None and len(self._nodes) >= MAX_NODES:
            raise InvalidArgumentError(f"ERROR: {MAX_NODES} nodes are already registered, which is the limit")
        replaced = None if known is None or known.api == node_api else known.api
        is_new = known is None or (replaced is None and (kind, key) not in known.registered)
        if is_new and self._count >= MAX_REGISTRATIONS:
            raise InvalidArgumentError(f"ERROR: there are {MAX_REGISTRATIONS} registrations, which is the limit")
        if known is not None and replaced is not None:
            self._forget(node, known)
        if known is None or replaced is not None:
            known = self._nodes[node] = _Node(node_api)
        self._count += (kind, key) not in known.registered
        known.registered.add((kind, key))
        there = self._providers[kind].setdefault(key, {})
        if kind is ProviderKind.SERVICE:
            there.clear()
        there[Provider(node, api or node_api)] = None
        return replaced

    def unregister(self, kind: ProviderKind, key: str, node: str, api: str) -> bool:
        """Remove a registration. Return False if it does not exist."""
        known = self._nodes.get(node)
        if known is None:
            return False
        found = self._remove(kind, key, Provider(node, api))
        if found:
            self._count -= (kind, key) in known.registered
            known.registered.discard((kind, key))
        if not known.registered:
            del self._nodes[node]
        return found

    def unsubscribe_all(self, key: str, api: str) -> None:
        """For all nodes with this slave API, remove the subscriptions to a parameter."""
        for provider in self.providers(ProviderKind.PARAMETER, key):
            if provider.api == api:
                self.unregister(ProviderKind.PARAMETER, key, provider.node, api)

    def _forget(self, node: str, known: _Node) -> None:
        self._count -= len(known.registered)
        for kind, key in known.registered:
            # A service has a URI of its own, so its provider is found by the node's name.
            provided = self._providers[kind].get(key, {}) if kind is ProviderKind.SERVICE else ()
            for provider in [each for each in provided if each.node == node] or [Provider(node, known.api)]:
                self._remove(kind, key, provider)

    def _remove(self, kind: ProviderKind, key: str, provider: Provider) -> bool:
        there = self._providers[kind].get(key, {})
        if provider not in there:
            return False
        del there[provider]
        if not there:
            del self._providers[kind][key]
        return True
