"""Registrations of publishers, subscribers and services: the graph as the master knows it.

Source: ROS's rosmaster/registrations.py.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from thbridge.protocols.rosgraph.xmlrpc import XmlRpcValue


class ProviderKind(Enum):
    """Kind of a registration with the master."""

    PUBLISHER = "publisher"
    SUBSCRIBER = "subscriber"
    SERVICE = "service"
    PARAMETER = "parameter"


@dataclass(frozen=True, slots=True)
class Provider:
    """Node that is registered for a topic, a service or a parameter.

    Args:
        node: its name, the caller id.
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

    A service has one provider, the last that registered; topics and parameters have as many as there are. Topics keep
    the order in which they were first registered.
    """

    def __init__(self) -> None:
        self._nodes: dict[str, _Node] = {}
        self._providers: dict[ProviderKind, dict[str, list[Provider]]] = {kind: {} for kind in ProviderKind}

    def keys(self, kind: ProviderKind) -> list[str]:
        """Return the topics, services or parameters with a registration."""
        return [*self._providers[kind]]

    def providers(self, kind: ProviderKind, key: str) -> tuple[Provider, ...]:
        """Return the registered nodes, in the order of registration."""
        return tuple(self._providers[kind].get(key, ()))

    def apis(self, kind: ProviderKind, key: str) -> list[str]:
        """Return the URIs of the registered nodes, in the order of registration."""
        return [provider.api for provider in self.providers(kind, key)]

    def api_of(self, node: str) -> str | None:
        """Return the URI of a node's slave API; None when it has no registration."""
        known = self._nodes.get(node)
        return None if known is None else known.api

    def state(self, kind: ProviderKind) -> list[XmlRpcValue]:
        """Return pairs of a key and the names of the nodes registered for it."""
        return [[key, [provider.node for provider in providers]] for key, providers in self._providers[kind].items()]

    def register(self, kind: ProviderKind, key: str, node: str, node_api: str, api: str | None = None) -> str | None:
        """Register a node.

        Args:
            kind: kind of the registration.
            key: the topic, service or parameter.
            node: the node's name.
            node_api: its slave API.
            api: URI of the service itself, for services.

        Returns:
            the slave API of another node of the same name that this one replaces, or None. All registrations of that
            node are removed.
        """
        known = self._nodes.get(node)
        replaced = None if known is None or known.api == node_api else known.api
        if known is None or replaced is not None:
            known = self._nodes[node] = _Node(node_api)
        if replaced is not None:
            self._forget(node)
        known.registered.add((kind, key))
        provider = Provider(node, api or node_api)
        there = self._providers[kind].setdefault(key, [])
        if kind is ProviderKind.SERVICE:
            there[:] = [provider]
        elif provider not in there:
            there.append(provider)
        return replaced

    def unregister(self, kind: ProviderKind, key: str, node: str, api: str) -> bool:
        """Remove a registration; return False when there is none like this."""
        known = self._nodes.get(node)
        if known is None:
            return False
        there = self._providers[kind].get(key, [])
        provider = Provider(node, api)
        found = provider in there
        if found:
            there.remove(provider)
            known.registered.discard((kind, key))
            if not there:
                del self._providers[kind][key]
        if not known.registered:
            del self._nodes[node]
        return found

    def unsubscribe_all(self, key: str, api: str) -> None:
        """Remove the subscriptions to a parameter of all nodes at a slave API."""
        for provider in self.providers(ProviderKind.PARAMETER, key):
            if provider.api == api:
                self.unregister(ProviderKind.PARAMETER, key, provider.node, api)

    def _forget(self, node: str) -> None:
        for kind, by_key in self._providers.items():
            self._providers[kind] = {
                key: rest
                for key, there in by_key.items()
                if (rest := [provider for provider in there if provider.node != node])
            }
