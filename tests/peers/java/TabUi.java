import java.io.BufferedReader;
import java.io.InputStreamReader;
import java.io.PrintWriter;
import java.net.Socket;
import java.nio.charset.StandardCharsets;

/**
 * The participant's program as one of 2016 would be, with a script in place of a participant: sends a robot to a room,
 * asks what is there, has a picture taken and names the treasure. It takes lines apart at fixed places, cuts fixed
 * numbers of characters off their ends and knows them by the words in them.
 *
 * <p>Usage: java TabUi.java HOST PORT ROBOT:ROOM:NAME... One visit after the other. Prints what it understood, one line
 * each; exit status 0 when every visit was scored, 1 when the server ended before.
 */
public final class TabUi {
    private final String[] visits;
    private final PrintWriter out;
    private int visit = -1;
    private int score = 0;

    private TabUi(String[] visits, PrintWriter out) {
        this.visits = visits;
        this.out = out;
    }

    public static void main(String[] args) throws Exception {
        String[] visits = java.util.Arrays.copyOfRange(args, 2, args.length);
        try (Socket socket = new Socket(args[0], Integer.parseInt(args[1]));
                PrintWriter out =
                        new PrintWriter(
                                new java.io.OutputStreamWriter(socket.getOutputStream(), StandardCharsets.UTF_8), true);
                BufferedReader in =
                        new BufferedReader(new InputStreamReader(socket.getInputStream(), StandardCharsets.UTF_8))) {
            TabUi tabui = new TabUi(visits, out);
            out.println("%%setid TabUI");
            tabui.sendRobot();
            String line;
            while (tabui.visit < visits.length && (line = in.readLine()) != null) {
                tabui.hear(line);
            }
            System.out.println("total " + tabui.score);
            System.exit(tabui.visit == visits.length ? 0 : 1);
        }
    }

    /** Ping before everything, acks after everything else: the order in which the old connector looked. */
    private void hear(String line) {
        if (line.contains("ping")) {
            out.println("%%pong");
        } else if (line.contains("error")) {
            arrive(line);
        } else if (line.contains("found")) {
            sense(line);
        } else if (line.contains("score")) {
            earn(line);
        } else if (line.contains("image")) {
            look(line);
        }
    }

    private void sendRobot() {
        visit++;
        if (visit < visits.length) {
            String room = visits[visit].split(":")[1];
            out.println("%%goto TabUI SimR " + visits[visit].split(":")[0] + " " + room + " " + room + " 45");
        }
    }

    private void arrive(String line) {
        String[] where = line.split("\"")[1].split(";");
        int robot = Integer.parseInt(where[0]);
        int room = Integer.parseInt(where[1]);
        System.out.println("reached robot=" + robot + " room=" + room);
        out.println("%%error TabUI Hider \"" + room + "\"");
    }

    /** Two characters go off the colour and three off the footprint, the last of them the blank that ends the line. */
    private void sense(String line) {
        String[] parts = line.split("\\(");
        String colour = parts[1].substring(0, parts[1].length() - 2);
        String footprint = parts[2].substring(0, parts[2].length() - 3);
        int room = Integer.parseInt(parts[0].split(" ")[4]);
        System.out.println("found room=" + room + " [" + colour + " " + footprint + "]");
        out.println("%%snap TabUI Hider " + room);
    }

    private void look(String line) {
        String[] words = line.split(" ");
        String picture = words[words.length - 1];
        int room = Integer.parseInt(words[words.length - 2]);
        System.out.println("image room=" + room + " [" + picture + "]");
        out.println("%%found TabUI Hider \"" + room + "," + visits[visit].split(":")[2]);
    }

    /** One character goes off the points: the blank that ends the line. */
    private void earn(String line) {
        String points = line.split(",")[1];
        points = points.substring(0, points.length() - 1);
        System.out.println("score " + Integer.parseInt(points));
        score += Integer.parseInt(points);
        sendRobot();
    }
}
