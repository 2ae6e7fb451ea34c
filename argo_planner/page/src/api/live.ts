/** A connection on which the service sends messages. It reconnects by itself. */

const SOONEST_MS = 250;
const LATEST_MS = 4_000;
const GONE = 4404;

export interface LiveHandlers<Message> {
  /** Returns path and query of the socket. It is called at each attempt, because the query names what is known. */
  address: () => string;
  onMessage: (message: Message) => void;
  /** Called when the connection opens or closes. */
  onConnection: (connected: boolean) => void;
  /** Called when the mission or run no longer exists; the connection is not reopened. */
  onDeleted?: () => void;
}

export class LiveConnection<Message> {
  private socket: WebSocket | null = null;
  private waiting: ReturnType<typeof setTimeout> | undefined;
  private pause = SOONEST_MS;
  private closed = false;

  constructor(private readonly handlers: LiveHandlers<Message>) {
    this.connect();
    addEventListener("online", this.retry);
    addEventListener("offline", this.lost);
  }

  send(message: object): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  close(): void {
    this.closed = true;
    removeEventListener("online", this.retry);
    removeEventListener("offline", this.lost);
    clearTimeout(this.waiting);
    if (this.socket) closeOnceOpen(this.socket);
  }

  /** The browser is offline. The socket itself would notice this only minutes later. */
  private readonly lost = (): void => {
    const socket = this.socket;
    if (socket === null) return;
    this.socket = null;
    closeOnceOpen(socket);
    this.ended();
  };

  private ended(): void {
    this.handlers.onConnection(false);
    this.waiting = setTimeout(this.retry, this.pause * (0.75 + Math.random() / 2));
    this.pause = Math.min(2 * this.pause, LATEST_MS);
  }

  private readonly retry = (): void => {
    if (this.socket !== null || this.closed) return;
    clearTimeout(this.waiting);
    this.connect();
  };

  private connect(): void {
    const url = new URL(this.handlers.address(), location.href);
    url.protocol = url.protocol.replace("http", "ws");
    const socket = new WebSocket(url);
    this.socket = socket;
    socket.onopen = () => {
      if (this.socket !== socket) return;
      this.pause = SOONEST_MS;
      this.handlers.onConnection(true);
    };
    socket.onmessage = (event: MessageEvent<string>) => {
      if (this.socket !== socket) return;
      this.handlers.onMessage(JSON.parse(event.data) as Message);
    };
    socket.onclose = (event) => {
      if (this.socket !== socket) return;
      this.socket = null;
      if (this.closed) return;
      if (event.code !== GONE) return this.ended();
      this.closed = true;
      this.handlers.onConnection(false);
      this.handlers.onDeleted?.();
    };
  }
}

/** Close the socket, but not before it is open: browsers report that as an error. */
function closeOnceOpen(socket: WebSocket): void {
  if (socket.readyState === WebSocket.CONNECTING) socket.addEventListener("open", () => socket.close());
  else socket.close();
}
